// Ticks of dense time from the times of Python callers.
#pragma once

#include "numbers.hpp"

#include <nanobind/nanobind.h>

#include <cmath>
#include <cstdint>
#include <optional>

namespace rtamt::python {

namespace nb = nanobind;

// Times stay this far from the ends of their range, so that bounds can be added to them.
inline constexpr double farthest = 0x1p62;

// Up to here a product of doubles is within half a tick of the truth; NEAR in counting.py.
inline constexpr double near = 0x1p50;

// Up to here every integer is a double.
inline constexpr double exact = 0x1p53;

// The tick of a time far from 0, where doubles are further apart than ticks: that of the shortest
// decimal that prints it (tick_of in counting.py says why).
[[nodiscard]] inline std::int64_t far_tick(double seconds, std::int64_t rate) noexcept {
    const double whole = std::trunc(seconds);
    const double rest = seconds - whole;
    const std::int64_t begin = static_cast<std::int64_t>(whole) * rate;
    if (rate % 1000 == 0) {
        for (const std::int64_t step : {1000, 100, 10}) {
            const std::int64_t steps_in_one = rate / step;
            const auto grid = static_cast<double>(steps_in_one);
            const double steps = std::nearbyint(rest * grid);
            if (whole + steps / grid == seconds) {
                return begin + static_cast<std::int64_t>(steps) * step;
            }
        }
    }
    return begin + static_cast<std::int64_t>(std::nearbyint(rest * static_cast<double>(rate)));
}

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
    const double tick = std::nearbyint(number * rate);
    if (!(std::fabs(tick) < farthest)) return std::nullopt;
    if (!(std::fabs(number) < implausible)) return std::nullopt;
    return std::fabs(tick) < near ? static_cast<std::int64_t>(tick)
                                  : far_tick(number, static_cast<std::int64_t>(rate));
}

} // namespace rtamt::python
