// The exceptions of the module, and how a failure of the core becomes one.
#pragma once

#include "../program/fault.hpp"
#include "calls.hpp"

#include <nanobind/nanobind.h>

#include <cstdint>
#include <exception>
#include <new>
#include <optional>
#include <stdexcept>

namespace rtamt::python {

struct Exceptions {
    nb::object refused;   // an update was rejected
    nb::object in_use;    // makes the one for a monitor that is in the middle of another call
    nb::object undefined; // an operation made NaN: instruction, sample or tick; and, of a call that
                          // failed, its message
};

// What the module's functions throw when memory runs out becomes Python's MemoryError, with the
// sentence that the C interface has.
inline void translate_memory(const std::exception_ptr& exception, void* /*payload*/) {
    constexpr const char* sentence = "There is not enough memory.";
    try {
        std::rethrow_exception(exception);
    } catch (const std::bad_alloc&) {
        PyErr_SetString(PyExc_MemoryError, sentence);
    } catch (const std::length_error&) { // of a container
        PyErr_SetString(PyExc_MemoryError, sentence);
    }
}

// Sets Undefined; its cause is what a Python operator raised, if one did, and its `time` that of
// the sample, where that is known here.
inline void set_undefined(const Exceptions& exceptions, Calls& calls, std::uint32_t instruction,
                          std::int64_t moment, const Fault& fault,
                          std::optional<double> time = std::nullopt) noexcept {
    const auto when = static_cast<long long>(moment);
    PyObject* raised = nullptr;
    if (fault) {
        const auto size = static_cast<Py_ssize_t>(fault.size()); // bytes of whoever wrote it
        raised = PyObject_CallFunction(exceptions.undefined.ptr(), "ILN", instruction, when,
                                       PyUnicode_DecodeUTF8(fault.data(), size, "replace"));
    } else {
        raised = PyObject_CallFunction(exceptions.undefined.ptr(), "IL", instruction, when);
    }
    if (raised == nullptr) return;
    if (time) {
        const auto seconds = nb::steal(PyFloat_FromDouble(*time));
        if (!seconds.is_valid() || PyObject_SetAttrString(raised, "time", seconds.ptr()) != 0) {
            Py_DECREF(raised);
            return;
        }
    }
    if (fault) PyException_SetCause(raised, calls.take_error().release().ptr());
    PyErr_SetObject(exceptions.undefined.ptr(), raised);
    Py_DECREF(raised);
}

[[noreturn]] inline void raise_undefined(const Exceptions& exceptions, Calls& calls,
                                         std::uint32_t instruction, std::int64_t moment,
                                         const Fault& fault,
                                         std::optional<double> time = std::nullopt) {
    set_undefined(exceptions, calls, instruction, moment, fault, time);
    throw nb::python_error();
}

} // namespace rtamt::python
