// A kernel that is not of the core: blocks of samples go to it through its table of functions.
//
// Cost: a call a block, one pass to look for NaN, and what the kernel itself takes. Memory: its
// own.
#pragma once

#include "../program/foreign.hpp"
#include "kernel.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace rtamt::discrete {

class Call final : public Kernel {
  public:
    Call(const rtamt_kernel& kernel, const rtamt_setup& setup, std::int64_t operand_lag,
         std::int64_t lag)
        : Kernel(operand_lag), foreign_(kernel, setup), result_lag_(lag) {}

    // Where the operands' registers are; again whenever they have moved.
    void connect_operands(std::vector<const double*> registers) {
        registers_ = std::move(registers);
        places_.resize(registers_.size());
    }

    std::size_t run(const Block& block) noexcept override {
        const Range fresh = block.present(lag());
        const Range due = block.present(result_lag_);
        for (std::size_t i = 0; i < registers_.size(); ++i)
            places_[i] = registers_[i] + fresh.begin;
        const bool last =
            block.slot + static_cast<std::int64_t>(block.count) >= block.samples + lag();
        fault_ = foreign_.run({places_.data(), fresh.end - fresh.begin, last,
                               out<double>() + due.begin, due.end - due.begin});
        if (fault_ != nullptr) return std::min(due.begin, block.count - 1);
        const double* values = out<double>();
        for (std::size_t place = due.begin; place < due.end; ++place) {
            if (std::isnan(values[place])) return place;
        }
        return defined;
    }

    [[nodiscard]] const char* fault() const noexcept override { return fault_; }
    void reset() noexcept override { foreign_.reset(); }
    void checkpoint(std::size_t /*count*/) noexcept override { foreign_.checkpoint(); }
    void rollback() noexcept override { foreign_.rollback(); }
    void transfer(Snapshot& /*snapshot*/) override { Foreign::refuse_transfer(); }

  private:
    Foreign foreign_;
    std::int64_t result_lag_;
    std::vector<const double*> registers_;
    std::vector<const double*> places_;
    const char* fault_ = nullptr;
};

} // namespace rtamt::discrete
