// The values of one sample, where reading them may run Python code, which lets other threads in and
// may call the monitor again: those of one call alone.
//
// Cost: a pass over the values. Memory: on the stack, unless the inputs are many.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <new>
#include <span>

// Of a function that is to be out of the way of those that are called for every sample.
#if defined(__GNUC__)
#define RTAMT_COLD [[gnu::cold, gnu::noinline]]
#else
#define RTAMT_COLD
#endif

namespace rtamt::python {

class Row {
  public:
    // No value yet: all are NaN, which no input is.
    explicit Row(std::size_t size) noexcept : size_(size) {
        if (size > few) many_.reset(new (std::nothrow) double[size]);
        if (*this) std::ranges::fill(values(), std::numeric_limits<double>::quiet_NaN());
    }

    // Whether there was memory for it.
    [[nodiscard]] explicit operator bool() const noexcept {
        return size_ <= few || many_ != nullptr;
    }

    [[nodiscard]] std::span<double> values() noexcept {
        return {size_ <= few ? few_.data() : many_.get(), size_};
    }

    // Takes the values that are still missing from another sample.
    void complete(std::span<const double> other) noexcept {
        const std::span<double> own = values();
        for (std::size_t i = 0; i < size_; ++i) {
            if (std::isnan(own[i])) own[i] = other[i];
        }
    }

  private:
    static constexpr std::size_t few = 16;
    std::size_t size_;
    std::array<double, few> few_{};
    std::unique_ptr<double[]> many_;
};

} // namespace rtamt::python
