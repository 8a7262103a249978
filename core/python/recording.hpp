// Reads samples that need no conversion: a dict of arrays and lists of numbers, or an array
// with a column for each variable, which is how pandas gives small frames at once.
//
// Whatever is not plainly right is left to Python (rtamt.signals), which converts it or reports
// what is wrong with it: there is one place for messages. Both read the same values to the bit.
//
// Cost: a pass over each column, and one to find the period. Memory: that of the copies.
#pragma once

#include "numpy.hpp"
#include "timestamps.hpp"

#include <nanobind/nanobind.h>

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace rtamt::python {

// Items of one type in memory, `step` bytes apart, whose type is a character of the buffer
// protocol.
struct Items {
    char format;
    const std::byte* first;
    std::size_t count;
    std::ptrdiff_t step;
};

// A column or the timestamps, as the caller gave them.
class Given {
  public:
    Given(const NumPy& numpy, nb::object object) noexcept;

    // Items of memory that another object keeps.
    explicit Given(const Items& items) noexcept : items_(items), count_(items.count) {}

    // Nothing for what is not read here.
    [[nodiscard]] std::optional<std::size_t> count() const noexcept { return count_; }

    // Whether all are numbers that are read here, and none is NaN.
    [[nodiscard]] bool copy(double* out) const noexcept;

    // The same of floats alone, NaN included; false for numbers of any other type.
    [[nodiscard]] bool copy_floats(double* out) const noexcept;

    // The numbers where they are, NaN included; null unless they are doubles one after another.
    [[nodiscard]] const double* in_place() const noexcept;

  private:
    nb::object object_;
    Buffer buffer_;
    std::optional<Items> items_; // of an array
    std::optional<std::size_t> count_;
};

// What a dict has under a name; invalid if it has none.
[[nodiscard]] nb::object item_of(const nb::handle& dict, const nb::handle& name) noexcept;

// The columns of these names, and the timestamps if there are any: all of one length, at least 1.
struct GivenColumns {
    Buffer table; // if the columns are those of one array
    std::vector<Given> columns;
    std::optional<Given> times;
    std::size_t count = 0;

    // Nothing for what is not read here.
    [[nodiscard]] static std::optional<GivenColumns> of(const NumPy& numpy, const nb::handle& data,
                                                        std::span<const nb::str> names,
                                                        const nb::handle& time);

    // The same; data may also be a tuple of an array and a dict from names to its columns.
    [[nodiscard]] static std::optional<GivenColumns>
    of_dict_or_table(const NumPy& numpy, const nb::handle& data, std::span<const nb::str> names,
                     const nb::handle& time);
};

// Whether a column of doubles has no NaN.
[[nodiscard]] bool all_numbers(std::span<const double> values) noexcept;

void add_recording(nb::module_& module);

} // namespace rtamt::python
