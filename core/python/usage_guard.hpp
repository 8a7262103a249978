// Rejects concurrent and reentrant use of a monitor, and samples after the end of the trace.
//
// A thread that is inside may have released the GIL, or run a Python operator that calls back. All
// methods of a monitor hold the GIL or, without one, a critical section of the monitor's object
// (locked_class.hpp), which protects the flag. Values are read before the guard is checked: reading
// them may run Python code, too. A rejected call has a Python exception set.
#pragma once

#include "arrays.hpp"

#include <nanobind/nanobind.h>

#include <cstddef>
#include <utility>

namespace rtamt::python {

namespace nb = nanobind;

class UsageGuard {
  public:
    // `refused` is the class of the exception for rejected samples, whose argument is a short
    // reason; `in_use` makes the exception for a monitor that another call is using.
    UsageGuard(nb::object refused, nb::object in_use)
        : refused_(std::move(refused)), in_use_(std::move(in_use)) {}

    PyObject* refuse(const char* reason) const noexcept {
        if (PyErr_Occurred() == nullptr) PyErr_SetString(refused_.ptr(), reason);
        return nullptr;
    }

    // Whether samples are accepted now; if not, a Python exception is set.
    [[nodiscard]] bool open(bool finished) const noexcept {
        if (!busy_ && !finished) [[likely]] {
            return true;
        }
        if (busy_) set_in_use();
        (void)refuse("finished");
        return false;
    }

    void require_idle() const { require(!busy_); }

    // Raises unless the condition holds: otherwise another call has used the monitor meanwhile.
    void require(bool holds) const {
        if (holds) return;
        set_in_use();
        throw nb::python_error();
    }

    // Works with the monitor taken, for as long as `count` samples take: without the GIL if they
    // are many.
    template <class Work>
    auto exclusively(std::size_t count, Work&& work) {
        const Closed closed(busy_);
        return without_gil(count, std::forward<Work>(work));
    }

    // The same with the GIL. A critical section may be suspended even where no Python code runs.
    template <class Work>
    auto briefly(Work&& work) {
        const Closed closed(busy_);
        return std::forward<Work>(work)();
    }

  private:
    struct Closed {
        bool& flag;
        explicit Closed(bool& busy) noexcept : flag(busy) { flag = true; }
        ~Closed() { flag = false; }
        Closed(const Closed&) = delete;
        Closed& operator=(const Closed&) = delete;
        Closed(Closed&&) = delete;
        Closed& operator=(Closed&&) = delete;
    };

    nb::object refused_;
    nb::object in_use_;
    bool busy_ = false;

    void set_in_use() const noexcept {
        const auto error = nb::steal(PyObject_CallNoArgs(in_use_.ptr()));
        if (error.is_valid()) PyErr_SetObject(error.type().ptr(), error.ptr());
    }
};

} // namespace rtamt::python
