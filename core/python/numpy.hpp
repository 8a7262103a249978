// Arrays of numpy, made and read without a copy. Small ones go through the buffer protocol:
// nanobind's arrays cost a microsecond each, as much as the evaluation of a short trace.
#pragma once

#include "large_memory.hpp"
#include "numpy_attribute.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <utility>
#include <vector>

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

    // Its items, of which the caller knows the type.
    template <class Item>
    [[nodiscard]] Item* values() const noexcept {
        return static_cast<Item*>(view_.buf);
    }

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
    double* memory = nullptr;

    [[nodiscard]] double* values() const noexcept { return memory; }
};

// The same of truths, a byte each.
struct NewBools {
    nb::object array;
    std::uint8_t* memory = nullptr;
};

class NumPy {
  public:
    // Whether this is an array, and of no derived class, whose values may mean something else.
    [[nodiscard]] bool is_array(PyObject* object) const noexcept {
        static constinit NumPyAttribute ndarray("ndarray");
        return reinterpret_cast<PyObject*>(Py_TYPE(object)) == ndarray.get_if_imported();
    }

    [[nodiscard]] NewArray make(std::size_t count) const {
        if (count * sizeof(double) < LargeMemory::least) return make_small(count);
        return std::move(make(1, count).front());
    }

    [[nodiscard]] NewBools make_bools(std::size_t count) const {
        static constinit NumPyAttribute truth("bool_");
        nb::object array = empty()(count, nb::handle(truth.get()));
        const Buffer buffer = writable(array);
        return {std::move(array), buffer.values<std::uint8_t>()};
    }

    // Several of the same length. Where they are small, but not together, some share a piece of
    // memory, which is there as long as one of them.
    [[nodiscard]] std::vector<NewArray> make(std::size_t arrays, std::size_t count) const {
        constexpr std::size_t most_shared = std::size_t{4} << 20U;
        std::vector<NewArray> made;
        made.reserve(arrays);
        const std::size_t bytes = count * sizeof(double);
        if (bytes < LargeMemory::least && (arrays == 1 || arrays * bytes < LargeMemory::least)) {
            for (std::size_t i = 0; i < arrays; ++i)
                made.push_back(make_small(count));
            return made;
        }
        while (made.size() < arrays) {
            const std::size_t fitting = std::max<std::size_t>(most_shared / bytes, 1);
            const std::size_t sharing = std::min(arrays - made.size(), fitting);
            const auto [memory, owner] = LargeMemory::owned(sharing * bytes);
            auto* values = static_cast<double*>(memory);
            for (std::size_t i = 0; i < sharing; ++i, values += count) {
                const nb::ndarray<nb::numpy, double, nb::ndim<1>> array(
                    values, std::initializer_list<std::size_t>{count}, owner);
                made.push_back({nb::cast(array), values});
            }
        }
        return made;
    }

  private:
    [[nodiscard]] static Buffer writable(const nb::object& array) {
        Buffer buffer(array.ptr(), PyBUF_WRITABLE);
        if (!buffer) throw nb::python_error();
        return buffer;
    }
    [[nodiscard]] static nb::handle empty() {
        static constinit NumPyAttribute empty("empty");
        return empty.get();
    }
    [[nodiscard]] static NewArray make_small(std::size_t count) {
        nb::object array = empty()(count);
        const Buffer buffer = writable(array);
        return {std::move(array), buffer.values<double>()};
    }
};

} // namespace rtamt::python
