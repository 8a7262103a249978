// Reads a trace that needs no conversion in one call: copies of the columns, the order and distance
// of the timestamps, and the period that they suggest (timestamps.cpp).
//
// Whatever is not plainly right is left to Python (rtamt.signals), which converts it or reports
// what is wrong with it: there is one place for messages. Both read the same values to the bit
// (tests/laws/test_recording_laws.py).
#include "recording.hpp"

#include "../values/vectors.hpp"
#include "arrays.hpp"
#include "numbers.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/vector.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

namespace rtamt::python {

namespace {

// ---- numbers ------------------------------------------------------------------------------------

struct NotANumber {
    // One of the values, if there is one.
    RTAMT_INLINE static double over(const double* values, std::size_t count) noexcept {
        double found = 0.0; // as wide as the values, for a loop of vector instructions
        for (std::size_t i = 0; i < count; ++i)
            found = std::isnan(values[i]) ? values[i] : found;
        return found;
    }
};

// Copies items as doubles; returns whether none is NaN.
template <class Item>
bool copy_items(const Items& items, double* out) noexcept {
    const auto count = static_cast<std::ptrdiff_t>(items.count);
    std::uint64_t wrong = 0; // as wide as a double, for a loop of vector instructions
    const auto copy = [&](std::ptrdiff_t step) {
        for (std::ptrdiff_t i = 0; i < count; ++i) {
            Item item; // NOLINT(*-pro-type-member-init,*-init-variables): memcpy writes it
            std::memcpy(&item, items.first + i * step, sizeof(Item));
            const auto number = static_cast<double>(item);
            out[i] = number;
            wrong |= static_cast<std::uint64_t>(std::isnan(number));
        }
    };
    constexpr auto next = static_cast<std::ptrdiff_t>(sizeof(Item));
    items.step == next ? copy(next) : copy(items.step);
    return wrong == 0;
}

// The same of doubles, which most are: as fast as memory where they are contiguous.
bool copy_doubles(const Items& items, double* out) noexcept {
    if (items.step != sizeof(double)) return copy_items<double>(items, out);
    std::memcpy(out, items.first, items.count * sizeof(double));
    return all_numbers({out, items.count});
}

bool copy_numbers(const Items& items, double* out) noexcept {
    switch (items.format) {
    case 'd':
        return copy_doubles(items, out);
    case 'f':
        return copy_items<float>(items, out);
    case '?':
        return copy_items<std::uint8_t>(items, out);
    case 'b':
        return copy_items<signed char>(items, out);
    case 'B':
        return copy_items<unsigned char>(items, out);
    case 'h':
        return copy_items<short>(items, out);
    case 'H':
        return copy_items<unsigned short>(items, out);
    case 'i':
        return copy_items<int>(items, out);
    case 'I':
        return copy_items<unsigned int>(items, out);
    case 'l':
        return copy_items<long>(items, out);
    case 'L':
        return copy_items<unsigned long>(items, out);
    case 'q':
        return copy_items<long long>(items, out);
    case 'Q':
        return copy_items<unsigned long long>(items, out);
    default:
        return false;
    }
}

} // namespace

bool all_numbers(std::span<const double> values) noexcept {
    return !std::isnan(vectorised<NotANumber>(values.size(), values.data(), values.size()));
}

// ---- columns ------------------------------------------------------------------------------------

Given::Given(const NumPy& numpy, nb::object object) noexcept : object_(std::move(object)) {
    PyObject* given = object_.ptr();
    if (numpy.is_array(given)) {
        buffer_ = Buffer(given, PyBUF_STRIDES | PyBUF_FORMAT);
        if (!buffer_) { // of dates, for instance
            PyErr_Clear();
        } else if (buffer_.view().ndim == 1) {
            const Py_buffer& view = buffer_.view();
            count_ = static_cast<std::size_t>(view.shape[0]);
            items_ = {buffer_.format(), buffer_.values<const std::byte>(), *count_,
                      view.strides[0]};
        }
    } else if (PyList_CheckExact(given) || PyTuple_CheckExact(given)) {
        count_ = static_cast<std::size_t>(sequence_size(given));
    }
}

bool Given::copy(double* out) const noexcept {
    if (items_) return copy_numbers(*items_, out);
    const nb::ft_object_guard guard(object_);
    if (std::cmp_not_equal(sequence_size(object_.ptr()), *count_)) return false;
    for (std::size_t i = 0; i < *count_; ++i) {
        PyObject* item = sequence_item(object_.ptr(), static_cast<Py_ssize_t>(i));
        if (!PlainNumbers::read(item, out[i])) return false;
    }
    return true;
}

bool Given::copy_floats(double* out) const noexcept {
    if (items_) {
        if (items_->format != 'd') return false;
        (void)copy_numbers(*items_, out);
        return true;
    }
    const nb::ft_object_guard guard(object_);
    if (std::cmp_not_equal(sequence_size(object_.ptr()), *count_)) return false;
    for (std::size_t i = 0; i < *count_; ++i) {
        PyObject* item = sequence_item(object_.ptr(), static_cast<Py_ssize_t>(i));
        if (PyFloat_CheckExact(item) == 0) return false;
        out[i] = float_value(item);
    }
    return true;
}

const double* Given::in_place() const noexcept {
    const bool plain = items_ && items_->format == 'd' && items_->step == sizeof(double) &&
                       reinterpret_cast<std::uintptr_t>(items_->first) % alignof(double) == 0;
    return plain ? reinterpret_cast<const double*>(items_->first) : nullptr;
}

nb::object item_of(const nb::handle& dict, const nb::handle& name) noexcept {
    const nb::ft_object_guard guard(dict);
    nb::object found = nb::borrow(PyDict_GetItemWithError(dict.ptr(), name.ptr()));
    if (!found.is_valid()) PyErr_Clear();
    return found;
}

namespace {

// Whether all columns are read here. `find` passes what makes the column of a name to a function,
// and returns false where there is none. `size`: of names.
template <class Find>
[[nodiscard]] bool take(GivenColumns& given, const Find& find, Py_ssize_t size,
                        std::span<const nb::str> names, const nb::handle& time) {
    given.columns.reserve(names.size());
    const auto add = [&](auto&&... parts) {
        given.columns.emplace_back(std::forward<decltype(parts)>(parts)...);
    };
    for (const nb::str& name : names) {
        if (!find(name, add)) return false;
        const auto count = given.columns.back().count();
        if (!count || *count != *given.columns.front().count()) return false;
        given.count = *count;
    }
    if (given.count == 0) return false;
    const auto set = [&](auto&&... parts) {
        given.times.emplace(std::forward<decltype(parts)>(parts)...);
    };
    if (find(time, set)) return given.times->count() == given.count;
    return std::cmp_less_equal(size, names.size()); // one of the others may hold the timestamps
}

} // namespace

std::optional<GivenColumns> GivenColumns::of(const NumPy& numpy, const nb::handle& data,
                                             std::span<const nb::str> names,
                                             const nb::handle& time) {
    if (!PyDict_CheckExact(data.ptr())) return std::nullopt;
    const auto find = [&](const nb::handle& name, const auto& use) {
        nb::object found = item_of(data, name);
        if (!found.is_valid()) return false;
        use(numpy, std::move(found));
        return true;
    };
    std::optional<GivenColumns> given(std::in_place);
    if (!take(*given, find, PyDict_Size(data.ptr()), names, time)) given.reset();
    return given;
}

std::optional<GivenColumns> GivenColumns::of_dict_or_table(const NumPy& numpy,
                                                           const nb::handle& data,
                                                           std::span<const nb::str> names,
                                                           const nb::handle& time) {
    if (!PyTuple_CheckExact(data.ptr())) return of(numpy, data, names, time);
    const auto pair = nb::borrow<nb::tuple>(data);
    const nb::object table = pair[0];
    const nb::object places = pair[1];
    std::optional<GivenColumns> given(std::in_place);
    given->table = Buffer(table.ptr(), PyBUF_STRIDES | PyBUF_FORMAT);
    if (!given->table) { // of dates, for instance
        PyErr_Clear();
        return std::nullopt;
    }
    const Py_buffer& view = given->table.view();
    if (view.ndim != 2) return std::nullopt;
    const auto find = [&](const nb::handle& name, const auto& use) {
        const nb::object place = item_of(places, name);
        Py_ssize_t column = -1;
        if (!place.is_valid() || !nb::try_cast(place, column)) return false;
        if (column < 0 || column >= view.shape[1]) return false;
        use(Items{given->table.format(),
                  given->table.values<const std::byte>() + column * view.strides[1],
                  static_cast<std::size_t>(view.shape[0]), view.strides[0]});
        return true;
    };
    if (!take(*given, find, PyDict_Size(places.ptr()), names, time)) given.reset();
    return given;
}

namespace {

// ---- the recording ------------------------------------------------------------------------------

nb::object read_columns(const NumPy& numpy, const nb::handle& data,
                        const std::vector<nb::str>& names, const nb::handle& time,
                        std::optional<double> period, double tolerance) {
    const auto given = GivenColumns::of_dict_or_table(numpy, data, names, time);
    if (!given) return nb::none();
    const std::size_t count = given->count;
    nb::object times = nb::none();
    if (given->times) {
        const NewArray made = numpy.make(count);
        const std::span<const double> seconds(made.values(), count);
        if (!given->times->copy(made.values()) || !ordered(seconds, {})) return nb::none();
        if (!period) period = inferred_period(seconds);
        if (!period) return nb::none();
        if (!regular(seconds, {}, *period, tolerance)) return nb::none();
        times = made.array;
    }
    nb::dict columns;
    for (std::size_t i = 0; i < names.size(); ++i) {
        const NewArray made = numpy.make(count);
        if (!given->columns[i].copy(made.values())) return nb::none();
        if (PyDict_SetItem(columns.ptr(), names[i].ptr(), made.array.ptr()) != 0) {
            throw nb::python_error();
        }
    }
    return nb::make_tuple(times, period, columns, count);
}

} // namespace

void add_recording(nb::module_& m) {
    m.def(
        "has_period",
        [](const Column& times, double period, double coarse) {
            return has_period({times.data(), times.shape(0)}, period, coarse);
        },
        nb::arg("times"), nb::arg("period"), nb::arg("coarse"),
        "Whether more than half of the gaps between timestamps in order are a period, and none "
        "that a decimal with one digit less describes as well; `coarse` is one in that digit.");
    m.def(
        "read_columns",
        [numpy = NumPy()](const nb::handle& data, const std::vector<nb::str>& names,
                          const nb::handle& time, std::optional<double> period, double tolerance) {
            return read_columns(numpy, data, names, time, period, tolerance);
        },
        nb::arg("data"), nb::arg("names"), nb::arg("time"), nb::arg("period").none(),
        nb::arg("tolerance"),
        "Copy the columns of a trace, a dict, or a tuple of an array and a dict from names to its "
        "columns; return the timestamps (None without), the period (inferred if None), columns "
        "by name and their length. None if anything has to be converted, or is wrong.");
}

} // namespace rtamt::python
