// The values of one sample, and which of them were given.
//
// Reading a value may run Python code, which lets other threads in and may call the monitor again:
// then a row belongs to one call alone. Rows that are read without Python code are reused.
//
// Cost: a pass over the values. Memory: on the stack, unless the inputs are many.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
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

// Where the values of a sample go, and where it is noted that they were given.
struct Places {
    double* values;
    bool* given;
    std::size_t size;

    void clear() const noexcept { std::fill_n(given, size, false); }

    // Whether every value was given.
    [[nodiscard]] bool whole() const noexcept {
        return std::find(given, given + size, false) == given + size;
    }
};

class Row {
  public:
    // Nothing is given yet.
    explicit Row(std::size_t size) noexcept : size_(size) {
        if (size <= few) return;
        more_values_.reset(new (std::nothrow) double[size]{});
        more_given_.reset(new (std::nothrow) bool[size]{});
    }

    // Whether there was memory for it.
    [[nodiscard]] explicit operator bool() const noexcept {
        return size_ <= few || (more_values_ != nullptr && more_given_ != nullptr);
    }

    [[nodiscard]] Places places() noexcept {
        if (size_ <= few) return {few_values_.data(), few_given_.data(), size_};
        return {more_values_.get(), more_given_.get(), size_};
    }

    // Takes the values that were not given from another sample.
    void complete(std::span<const double> other) noexcept {
        const Places own = places();
        for (std::size_t i = 0; i < size_; ++i) {
            if (!own.given[i]) own.values[i] = other[i];
            own.given[i] = true;
        }
    }

  private:
    static constexpr std::size_t few = 16;
    std::size_t size_;
    std::array<double, few> few_values_{};
    std::array<bool, few> few_given_{};
    std::unique_ptr<double[]> more_values_;
    std::unique_ptr<bool[]> more_given_;
};

} // namespace rtamt::python
