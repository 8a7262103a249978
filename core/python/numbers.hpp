// Real numbers from Python objects.
#pragma once

#include "../values/ticks.hpp"
#include "../values/vectors.hpp"
#include "cpython.hpp"
#include "numpy_attribute.hpp"

#include <nanobind/nanobind.h>

#include <cmath>

namespace rtamt::python {

namespace nb = nanobind;

using ticks::implausible;

// Clears a Python exception for an object that is not a number or is too large.
inline bool forget_no_number() noexcept {
    if (PyErr_ExceptionMatches(PyExc_TypeError) != 0 ||
        PyErr_ExceptionMatches(PyExc_OverflowError) != 0) {
        PyErr_Clear();
    }
    return false;
}

// The numbers that are read without running any Python code: what nearly all values are. False for
// all others, and for NaN.
struct PlainNumbers {
    static constexpr bool plain = true;

    [[nodiscard]] RTAMT_INLINE static bool read(PyObject* object, double& value) noexcept {
        if (PyFloat_Check(object)) [[likely]] {
            value = float_value(object);
            return !std::isnan(value);
        }
        if (!PyLong_CheckExact(object) && !PyBool_Check(object)) return false;
        value = PyLong_AsDouble(object);
        return value != -1.0 || PyErr_Occurred() == nullptr || forget_no_number();
    }
};

// What is wrong with a sample that reading it without Python code cannot decide.
inline constexpr const char* not_plain = "not plain";

// What is wrong with a name that is not found.
template <class Numbers>
[[nodiscard]] const char* no_name(const Numbers& /*numbers*/, PyObject* name) noexcept {
    return Numbers::plain && PyUnicode_CheckExact(name) == 0 ? not_plain : "names";
}

// What is wrong with a value that is not read.
template <class Numbers>
[[nodiscard]] const char* no_number(const Numbers& /*numbers*/, const char* wrong) noexcept {
    return Numbers::plain ? not_plain : wrong;
}

// Reads numbers: float and int directly, and instances of numbers.Real and numpy's bool. Strings,
// decimals and arrays are not numbers.
class Numbers {
  public:
    static constexpr bool plain = false;

    Numbers() : real_(nb::module_::import_("numbers").attr("Real")) {}

    // False for what is no number, for one that no double holds, and for NaN. What the object
    // itself raises stays set.
    [[nodiscard]] bool read(PyObject* object, double& value) const noexcept {
        if (PyFloat_CheckExact(object)) [[likely]] {
            value = float_value(object);
            return !std::isnan(value);
        }
        Py_INCREF(object); // its own __float__ may drop the last reference
        const bool number = convert(object, value);
        Py_DECREF(object);
        return number && !std::isnan(value);
    }

  private:
    nb::object real_;

    // Whether an object that is neither float nor int is a number. Durations of numpy, which
    // derives them from its integers, are none.
    [[nodiscard]] bool is_other_number(PyObject* object) const noexcept {
        static constinit NumPyAttribute truth("bool_");
        static constinit NumPyAttribute duration("timedelta64");
        PyObject* truths = truth.get_if_imported();
        if (truths != nullptr && is_instance(object, truths)) return true;
        if (PyObject_IsInstance(object, real_.ptr()) <= 0) return false;
        PyObject* durations = duration.get_if_imported();
        return durations == nullptr || !is_instance(object, durations);
    }

    [[nodiscard]] static bool is_instance(PyObject* object, PyObject* type) noexcept {
        return PyObject_TypeCheck(object, reinterpret_cast<PyTypeObject*>(type)) != 0;
    }

    [[nodiscard]] bool convert(PyObject* object, double& value) const noexcept {
        if (!PyFloat_Check(object) && !PyLong_Check(object) && !is_other_number(object)) {
            return false;
        }
        value = PyFloat_AsDouble(object);
        // A long double may have overflowed: the Python caller decides.
        if (std::isinf(value) && !PyFloat_Check(object)) return false;
        return value != -1.0 || PyErr_Occurred() == nullptr || forget_no_number();
    }
};

} // namespace rtamt::python
