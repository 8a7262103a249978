// One piece of memory for the state of all kernels, handed out front to back.
//
// Cost: one allocation. Nothing is written, so of a window of a million samples only those pages
// are ever resident that a sample has reached (calloc maps large pieces lazily).
#pragma once

#include <cstddef>
#include <cstdlib>
#include <limits>
#include <memory>
#include <new>

namespace rtamt::discrete {

class Arena {
  public:
    explicit Arena(std::size_t bytes) : size_(bytes) {
        if (bytes == 0) return;
        if (bytes > static_cast<std::size_t>(std::numeric_limits<std::ptrdiff_t>::max())) {
            throw std::bad_alloc();
        }
        // NOLINTNEXTLINE(*-no-malloc): operator new would promise nothing about untouched pages
        memory_.reset(static_cast<std::byte*>(std::calloc(bytes, 1)));
        if (!memory_) throw std::bad_alloc();
    }

    // The next `bytes`, aligned for values as long as all sizes are multiples of 8; the sum of all
    // pieces is the size given at the start.
    [[nodiscard]] void* take(std::size_t bytes) noexcept {
        std::byte* piece = memory_.get() + taken_;
        taken_ += bytes;
        return piece;
    }

    [[nodiscard]] std::size_t bytes() const noexcept { return size_; }

  private:
    struct Free {
        void operator()(std::byte* memory) const noexcept {
            std::free(memory); // NOLINT(*-no-malloc): goes with calloc
        }
    };
    std::unique_ptr<std::byte, Free> memory_;
    std::size_t size_;
    std::size_t taken_ = 0;
};

} // namespace rtamt::discrete
