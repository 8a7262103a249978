// Real numbers from Python objects.
#pragma once

#include <nanobind/nanobind.h>

#include <cmath>

namespace rtamt::python {

namespace nb = nanobind;

// What counts as a number: float and int at once; else whatever calls itself a numbers.Real, and
// numpy's bool. Strings, decimals and arrays do not.
class Numbers {
  public:
    Numbers()
        : accepted_(nb::make_tuple(nb::module_::import_("numbers").attr("Real"),
                                   nb::module_::import_("numpy").attr("bool_"))) {}

    // False for what is no number and for NaN. A Python exception that the object raises counts as
    // no number; only what is no ordinary error (KeyboardInterrupt) stays set.
    [[nodiscard]] bool read(PyObject* object, double& value) const noexcept {
        if (PyFloat_CheckExact(object)) [[likely]] {
            value = PyFloat_AS_DOUBLE(object);
            return !std::isnan(value);
        }
        Py_INCREF(object); // its own __float__ may drop the last reference
        const bool number = convert(object, value);
        Py_DECREF(object);
        return number && !std::isnan(value);
    }

  private:
    nb::object accepted_;

    [[nodiscard]] bool convert(PyObject* object, double& value) const noexcept {
        if (!PyFloat_Check(object) && !PyLong_Check(object)) {
            const int real = PyObject_IsInstance(object, accepted_.ptr());
            if (real == 0) return false;
            if (real < 0) return forget();
        }
        value = PyFloat_AsDouble(object);
        return value != -1.0 || PyErr_Occurred() == nullptr || forget();
    }

    static bool forget() noexcept {
        if (PyErr_ExceptionMatches(PyExc_Exception) != 0) PyErr_Clear();
        return false;
    }
};

} // namespace rtamt::python
