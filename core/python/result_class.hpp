// A Python class of objects with slots, which are filled without a call of Python code.
#pragma once

#include <nanobind/nanobind.h>

#include <array>
#include <cstddef>
#include <stdexcept>
#include <string>

namespace rtamt::python {

namespace nb = nanobind;

template <std::size_t count>
class ResultClass {
  public:
    ResultClass(const nb::object& type, const std::array<const char*, count>& slots)
        : type_(type),
          allocate_(reinterpret_cast<allocfunc>(PyType_GetSlot(own_type(), Py_tp_alloc))) {
        for (std::size_t i = 0; i < count; ++i) {
            slots_[i] = nb::getattr(type, slots[i]);
            auto* descriptor = Py_TYPE(slots_[i].ptr());
            set_[i] = reinterpret_cast<descrsetfunc>(PyType_GetSlot(descriptor, Py_tp_descr_set));
            if (set_[i] == nullptr) {
                throw std::invalid_argument("The class of the results has no attribute '" +
                                            std::string(slots[i]) + "' that can be set.");
            }
        }
    }

    // Null, with a Python exception set, where that fails.
    [[nodiscard]] PyObject* make(const std::array<nb::handle, count>& values) const noexcept {
        auto made = nb::steal(allocate_(own_type(), 0));
        if (!made.is_valid()) return nullptr;
        for (std::size_t i = 0; i < count; ++i) {
            if (!values[i].is_valid()) return nullptr;
            if (set_[i](slots_[i].ptr(), made.ptr(), values[i].ptr()) != 0) return nullptr;
        }
        return made.release().ptr();
    }

    // Throws nb::python_error where that fails.
    [[nodiscard]] nb::object made(const std::array<nb::handle, count>& values) const {
        nb::object instance = nb::steal(make(values));
        if (!instance.is_valid()) throw nb::python_error();
        return instance;
    }

  private:
    nb::object type_;
    allocfunc allocate_;
    std::array<nb::object, count> slots_; // descriptors, and what sets them
    std::array<descrsetfunc, count> set_{};

    [[nodiscard]] PyTypeObject* own_type() const noexcept {
        return reinterpret_cast<PyTypeObject*>(type_.ptr());
    }
};

} // namespace rtamt::python
