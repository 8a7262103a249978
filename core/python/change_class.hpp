// A Python class of named tuples (begin, end, interval, final, retracted), which are filled without
// a call of Python code: what changes() of a monitor of bounds returns.
#pragma once

#include "../values/bounds.hpp"
#include "cpython.hpp"
#include "result_class.hpp"

#include <array>

namespace rtamt::python {

class ChangeClass {
  public:
    ChangeClass(const nb::object& change, const nb::object& interval)
        : change_(change), interval_(interval, std::array{"lower", "upper"}),
          new_(reinterpret_cast<newfunc>(PyType_GetSlot(&PyTuple_Type, Py_tp_new))) {
        if (PyType_Check(change.ptr()) == 0 || PyType_IsSubtype(type(), &PyTuple_Type) == 0) {
            throw std::invalid_argument("The class of changes is no class of tuples.");
        }
    }

    // Null, with a Python exception set, where that fails.
    [[nodiscard]] PyObject* make(double begin, double end, const Bounds& bounds,
                                 bool is_final) const noexcept {
        const auto first = nb::steal(PyFloat_FromDouble(begin));
        const auto last = begin == end ? first : nb::steal(PyFloat_FromDouble(end));
        const auto interval =
            nb::steal(interval_.make({nb::steal(PyFloat_FromDouble(bounds.lower)),
                                      nb::steal(PyFloat_FromDouble(bounds.upper))}));
        if (!first.is_valid() || !last.is_valid() || !interval.is_valid()) return nullptr;
        const auto fields = nb::steal(PyTuple_Pack(5, first.ptr(), last.ptr(), interval.ptr(),
                                                   is_final ? Py_True : Py_False, Py_False));
        if (!fields.is_valid()) return nullptr;
        const auto arguments = nb::steal(PyTuple_Pack(1, fields.ptr()));
        return arguments.is_valid() ? new_(type(), arguments.ptr(), nullptr) : nullptr;
    }

  private:
    nb::object change_;
    ResultClass<2> interval_;
    newfunc new_;

    [[nodiscard]] PyTypeObject* type() const noexcept {
        return reinterpret_cast<PyTypeObject*>(change_.ptr());
    }
};

} // namespace rtamt::python
