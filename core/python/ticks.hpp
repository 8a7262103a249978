// Ticks of dense time from the times of Python callers.
#pragma once

#include "../values/ticks.hpp"
#include "numbers.hpp"

#include <nanobind/nanobind.h>

#include <cmath>
#include <cstdint>
#include <optional>

namespace rtamt::python {

namespace nb = nanobind;

using ticks::exact;
using ticks::farthest;
using ticks::near;

// The tick of a plain time, of which 1 is `rate` ticks: of a float or an int, rounded to the
// nearest and halves to the even one; where times are `whole`, of an integer of any kind, without a
// double in between, which may run Python code. Nothing if Python has to report the error.
[[nodiscard]] inline std::optional<std::int64_t> tick_of(PyObject* time, double rate,
                                                         bool whole) noexcept {
    if (whole) {
        if (PyBool_Check(time) || PyIndex_Check(time) == 0) return std::nullopt;
        const nb::object index = nb::steal(PyNumber_Index(time));
        const std::int64_t number = index.is_valid() ? PyLong_AsLongLong(index.ptr()) : -1;
        if (number == -1 && PyErr_Occurred() != nullptr && !forget_no_number()) return std::nullopt;
        if (!(std::fabs(static_cast<double>(number)) * rate < farthest)) return std::nullopt;
        return number * static_cast<std::int64_t>(rate);
    }
    double number = 0.0;
    if (PyFloat_Check(time)) {
        number = float_value(time);
    } else if (PyLong_CheckExact(time)) {
        number = PyLong_AsDouble(time);
        if (PyErr_Occurred() != nullptr && !forget_no_number()) return std::nullopt;
        if (!(std::fabs(number) < exact)) return std::nullopt;
    } else {
        return std::nullopt;
    }
    return ticks::tick_of(number, rate);
}

} // namespace rtamt::python
