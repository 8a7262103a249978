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

namespace rtamt {

class Arena {
  public:
    explicit Arena(std::size_t doubles) : size_(doubles) {
        if (doubles == 0) return;
        if (doubles > std::numeric_limits<std::ptrdiff_t>::max() / sizeof(double)) {
            throw std::bad_alloc();
        }
        // NOLINTNEXTLINE(*-no-malloc): operator new would promise nothing about untouched pages
        memory_.reset(static_cast<double*>(std::calloc(doubles, sizeof(double))));
        if (!memory_) throw std::bad_alloc();
    }

    // The next `doubles` cells; the sum of all pieces is the size given at the start.
    [[nodiscard]] double* take(std::size_t doubles) noexcept {
        double* piece = memory_.get() + taken_;
        taken_ += doubles;
        return piece;
    }

    [[nodiscard]] std::size_t bytes() const noexcept { return size_ * sizeof(double); }

  private:
    struct Free {
        void operator()(double* memory) const noexcept {
            std::free(memory); // NOLINT(*-no-malloc)
        }
    };
    std::unique_ptr<double, Free> memory_;
    std::size_t size_;
    std::size_t taken_ = 0;
};

} // namespace rtamt
