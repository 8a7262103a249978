// Arrays of numpy, made and read without a copy through the buffer protocol: nanobind's arrays cost
// a microsecond each, as much as the evaluation of a short trace.
#pragma once

#include <nanobind/nanobind.h>

#include <cstddef>
#include <utility>

namespace rtamt::python {

namespace nb = nanobind;

// The memory of an object, for as long as this exists.
class Buffer {
  public:
    Buffer() = default;

    // Without memory where the object has none of this kind; a Python exception is then set.
    Buffer(PyObject* object, int flags) noexcept
        : held_(PyObject_GetBuffer(object, &view_, flags) == 0) {}

    Buffer(Buffer&& other) noexcept
        : view_(other.view_), held_(std::exchange(other.held_, false)) {}
    Buffer& operator=(Buffer&& other) noexcept {
        std::swap(view_, other.view_);
        std::swap(held_, other.held_);
        return *this;
    }
    Buffer(const Buffer&) = delete;
    Buffer& operator=(const Buffer&) = delete;
    ~Buffer() {
        if (held_) PyBuffer_Release(&view_);
    }

    [[nodiscard]] explicit operator bool() const noexcept { return held_; }
    [[nodiscard]] const Py_buffer& view() const noexcept { return view_; }

    // The only character of the format of its items; 0 if there are others.
    [[nodiscard]] char format() const noexcept {
        const char* format = view_.format;
        return format != nullptr && format[0] != '\0' && format[1] == '\0' ? format[0] : '\0';
    }

  private:
    Py_buffer view_{};
    bool held_ = false;
};

// A new array of doubles, and its memory.
struct NewArray {
    nb::object array;
    Buffer buffer;

    [[nodiscard]] double* values() const noexcept {
        return static_cast<double*>(buffer.view().buf);
    }
};

class NumPy {
  public:
    NumPy() : ndarray_(module().attr("ndarray")), empty_(module().attr("empty")) {}

    // Whether this is an array, and of no derived class, whose values may mean something else.
    [[nodiscard]] bool is_array(PyObject* object) const noexcept {
        return reinterpret_cast<PyObject*>(Py_TYPE(object)) == ndarray_.ptr();
    }

    // Its memory is numpy's, which uses huge pages for large arrays.
    [[nodiscard]] NewArray make(std::size_t count) const {
        NewArray made{empty_(count), {}};
        made.buffer = Buffer(made.array.ptr(), PyBUF_WRITABLE);
        if (!made.buffer) throw nb::python_error();
        return made;
    }

  private:
    nb::object ndarray_;
    nb::object empty_;

    [[nodiscard]] static nb::module_ module() { return nb::module_::import_("numpy"); }
};

} // namespace rtamt::python
