// Who may use a monitor: one thread at a time, and nobody brings samples after the end.
//
// A thread that is inside may have given up the GIL, or be in a Python operator or a __float__ that
// calls back. What is refused is refused with a Python exception set; nothing here allocates.
#pragma once

#include "arrays.hpp"

#include <nanobind/nanobind.h>

#include <cstddef>
#include <stdexcept>
#include <utility>

namespace rtamt::python {

namespace nb = nanobind;

class Gate {
  public:
    // `refused` is the class of the exception that says, in a word, why samples are not taken.
    explicit Gate(nb::object refused) : refused_(std::move(refused)) {}

    PyObject* refuse(const char* reason) const noexcept {
        if (PyErr_Occurred() == nullptr) PyErr_SetString(refused_.ptr(), reason);
        return nullptr;
    }

    // Whether samples may come now; if not, a Python exception is set.
    [[nodiscard]] bool open(bool finished) const noexcept {
        if (!busy_ && !finished) [[likely]] {
            return true;
        }
        if (busy_) PyErr_SetString(PyExc_RuntimeError, in_use);
        (void)refuse("finished");
        return false;
    }

    void require_idle() const {
        if (busy_) throw std::runtime_error(in_use);
    }

    // Works with the gate closed, for as long as `count` samples take: without the GIL if they are
    // many.
    template <class Work>
    auto exclusively(std::size_t count, Work&& work) {
        const Closed closed(busy_);
        return without_gil(count, std::forward<Work>(work));
    }

    // The same at once, with the GIL.
    template <class Work>
    auto briefly(Work&& work) {
        const Closed closed(busy_);
        return std::forward<Work>(work)();
    }

  private:
    static constexpr const char* in_use =
        "The monitor is in use by another thread: give each thread a monitor of its own.";

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
    bool busy_ = false;
};

} // namespace rtamt::python
