// The type of an input, which decides how the object that a caller passes becomes a number.
#pragma once

#include "../values/vectors.hpp"
#include "cpython.hpp"
#include "numbers.hpp"

#include <nanobind/nanobind.h>

#include <stdexcept>

namespace rtamt::python {

namespace nb = nanobind;

// A number stays as it is. A Boolean is 1 or 0, and no other number. A member of an enumeration may
// be given by its name, or as a member of a Python enum with that name, and becomes its code.
//
// Cost: a comparison for numbers and Booleans, a look-up in a dict for names.
class ValueType {
  public:
    ValueType() = default; // of numbers

    // `codes`: from each member's name to its code, a float; None for a Boolean.
    explicit ValueType(nb::handle codes) {
        if (codes.is_none()) {
            kind_ = Kind::boolean;
            return;
        }
        kind_ = Kind::enumeration;
        codes_ = nb::dict();
        for (const auto& [name, code] : nb::cast<nb::dict>(codes)) {
            if (PyUnicode_CheckExact(name.ptr()) == 0 || PyFloat_CheckExact(code.ptr()) == 0) {
                throw std::invalid_argument("The codes of an enumeration map str to float.");
            }
            codes_[name] = code;
        }
        python_enum_ = nb::module_::import_("enum").attr("Enum");
    }

    // Whether it is that of numbers.
    [[nodiscard]] bool plain() const noexcept { return kind_ == Kind::number; }

    // As Numbers::read; also false for what is no value of the type.
    template <class Numbers>
    [[nodiscard]] RTAMT_INLINE bool read(const Numbers& numbers, PyObject* object,
                                         double& value) const noexcept {
        if (kind_ == Kind::number) [[likely]] {
            return numbers.read(object, value);
        }
        if (kind_ == Kind::boolean) {
            return numbers.read(object, value) && (value == 0.0 || value == 1.0);
        }
        if (PyUnicode_CheckExact(object)) return code_of(object, value);
        // An instance of a derived class may be a member of a Python enum.
        if (PyFloat_CheckExact(object) || PyLong_CheckExact(object)) {
            return numbers.read(object, value);
        }
        if constexpr (Numbers::plain) {
            return false;
        } else {
            return read_any(numbers, object, value);
        }
    }

  private:
    enum class Kind : unsigned char { number, boolean, enumeration };
    Kind kind_ = Kind::number;
    nb::object codes_;       // a dict of an enumeration
    nb::object python_enum_; // enum.Enum

    [[nodiscard]] bool code_of(PyObject* name, double& value) const noexcept {
        PyObject* code = PyDict_GetItemWithError(codes_.ptr(), name);
        if (code == nullptr) return false;
        value = float_value(code);
        return true;
    }

    template <class Numbers>
    [[nodiscard]] bool read_any(const Numbers& numbers, PyObject* object,
                                double& value) const noexcept {
        const int member = PyObject_IsInstance(object, python_enum_.ptr());
        if (member < 0) return false;
        if (member > 0) {
            const auto name = nb::steal(PyObject_GetAttrString(object, "name"));
            return name.is_valid() && code_of(name.ptr(), value);
        }
        return PyUnicode_Check(object) ? code_of(object, value) : numbers.read(object, value);
    }
};

} // namespace rtamt::python
