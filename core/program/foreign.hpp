// The state of one call: a kernel that is not of the core, through its table (rtamt/kernel.hpp).
#pragma once

#include <rtamt/kernel.hpp>

#include <memory>
#include <stdexcept>
#include <string>

namespace rtamt {

class Foreign {
  public:
    Foreign(const rtamt_kernel& kernel, const rtamt_setup& setup)
        : kernel_(&kernel), state_(nullptr, Destroy{kernel.destroy}) {
        const char* error = nullptr;
        state_.reset(kernel.create(kernel.context, &setup, &error));
        if (!state_) throw std::runtime_error(error != nullptr ? error : "unknown reason");
    }

    [[nodiscard]] const char* run(const rtamt_samples& samples) noexcept {
        return kernel_->run(state_.get(), &samples);
    }
    [[nodiscard]] const char* advance(const rtamt_stretch& stretch) noexcept {
        return kernel_->advance(state_.get(), &stretch);
    }
    void reset() noexcept { kernel_->reset(state_.get()); }
    void checkpoint() noexcept { kernel_->checkpoint(state_.get()); }
    void rollback() noexcept { kernel_->rollback(state_.get()); }

    // What such a kernel remembers is its own affair.
    [[noreturn]] static void refuse_transfer() {
        throw std::invalid_argument(
            "The state of a kernel that is not of the core cannot be copied.");
    }

  private:
    struct Destroy {
        void (*function)(void*) = nullptr;
        void operator()(void* state) const noexcept { function(state); }
    };
    const rtamt_kernel* kernel_;
    std::unique_ptr<void, Destroy> state_;
};

} // namespace rtamt
