// Methods that are plain functions of CPython.
#pragma once

#include <nanobind/nanobind.h>

namespace rtamt::python {

namespace nb = nanobind;

// The method descriptor has checked the type of self, but not that __init__ has run.
template <class Self>
Self* self_of(PyObject* self) noexcept { // NOLINT(misc-const-correctness): CPython hands it over so
    if (nb::inst_ready(self)) [[likely]] {
        return nb::inst_ptr<Self>(self);
    }
    PyErr_SetString(PyExc_TypeError, "The monitor was never initialised.");
    return nullptr;
}

// CPython stores every kind of method as a PyCFunction and calls it by its METH_ flags.
template <class Function>
PyCFunction erased(Function* function) noexcept {
    return reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(function));
}

} // namespace rtamt::python
