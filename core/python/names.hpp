// The inputs of a program: their names, looked up by the Python strings that a caller passes, and
// their types.
#pragma once

#include "../values/vectors.hpp"
#include "cpython.hpp"
#include "value_type.hpp"

#include <nanobind/nanobind.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace rtamt::python {

namespace nb = nanobind;

// Values by name, as a call passes them: a tuple of names (null: none), and as many values.
struct Named {
    PyObject* names;
    PyObject* const* values;

    [[nodiscard]] std::size_t count() const noexcept {
        return names == nullptr ? 0 : static_cast<std::size_t>(tuple_size(names));
    }

    // Calls `take` with every name and value until it returns what is wrong; null if nothing is.
    template <class Take>
    RTAMT_INLINE const char* each(Take&& take) const noexcept {
        for (std::size_t i = 0; i < count(); ++i) {
            const char* wrong = take(tuple_item(names, static_cast<Py_ssize_t>(i)), values[i]);
            if (wrong != nullptr) return wrong;
        }
        return nullptr;
    }
};

// The same in a dict; anything else has more names than there are. What runs while a value is read
// may change the dict.
struct InDict {
    PyObject* dict;

    [[nodiscard]] std::size_t count() const noexcept {
        return PyDict_Check(dict) ? static_cast<std::size_t>(dict_size(dict)) : SIZE_MAX;
    }

    template <class Take>
    const char* each(Take&& take) const noexcept {
        if (!PyDict_Check(dict)) return "names";
        Py_ssize_t position = 0;
        PyObject* name = nullptr;
        PyObject* value = nullptr;
        while (PyDict_Next(dict, &position, &name, &value) != 0) {
            const nb::object held[] = {nb::borrow(name), nb::borrow(value)};
            const char* wrong = take(name, value);
            if (wrong != nullptr) return wrong;
        }
        return nullptr;
    }
};

class Names {
  public:
    // `ignored` are names of variables that exist and are not read: a collection, or None. `types`
    // has what ValueType takes of the inputs that are no plain numbers.
    Names(const std::vector<nb::str>& names, std::size_t inputs, const nb::object& ignored,
          const nb::dict& types)
        : types_(names.size()) {
        if (names.size() != inputs) {
            throw std::invalid_argument("Got " + std::to_string(names.size()) +
                                        " names for a program with " + std::to_string(inputs) +
                                        " inputs.");
        }
        for (const nb::str& name : names) {
            if (places_.contains(name)) {
                throw std::invalid_argument("Two inputs are called '" + std::string(name.c_str()) +
                                            "'.");
            }
            places_[name] = nb::int_(names_.size());
            PyObject* interned = nb::object(name).release().ptr();
            PyUnicode_InternInPlace(&interned);
            names_.push_back(nb::steal<nb::str>(interned));
        }
        for (const auto& [name, codes] : types) {
            if (!places_.contains(name)) throw std::invalid_argument("A type has no input.");
            types_[nb::cast<std::size_t>(places_[name])] = ValueType(codes);
        }
        ignored_ =
            nb::steal<nb::object>(PyFrozenSet_New(ignored.is_none() ? nullptr : ignored.ptr()));
        if (!ignored_.is_valid()) throw nb::python_error();
    }

    [[nodiscard]] std::size_t count() const noexcept { return names_.size(); }
    [[nodiscard]] std::span<const nb::str> all() const noexcept { return names_; }

    // Whether all values are plain numbers.
    [[nodiscard]] bool plain() const noexcept {
        return std::ranges::all_of(types_, &ValueType::plain);
    }

    // The index of the input of this name, which is probably the one guessed; or nothing. If it is
    // to be found without running Python code (`plain`), nothing for what is not quite a str.
    [[nodiscard]] RTAMT_INLINE std::optional<std::size_t> place(PyObject* name, std::size_t guess,
                                                                bool plain) const noexcept {
        if (guess < names_.size() && names_[guess].ptr() == name) [[likely]] {
            return guess;
        }
        if (plain && !PyUnicode_CheckExact(name)) return std::nullopt;
        PyObject* index = PyDict_GetItemWithError(places_.ptr(), name);
        if (index == nullptr) {
            PyErr_Clear(); // what cannot be hashed is no name
            return std::nullopt;
        }
        return PyLong_AsSize_t(index);
    }

    [[nodiscard]] bool ignored(PyObject* name, bool plain) const noexcept {
        if (plain && !PyUnicode_CheckExact(name)) return false;
        const int found = PySet_Contains(ignored_.ptr(), name);
        if (found < 0) PyErr_Clear(); // what cannot be hashed is no name
        return found > 0;
    }

    // As Numbers::read, of a value of this input.
    template <class Numbers>
    [[nodiscard]] RTAMT_INLINE bool read(const Numbers& numbers, std::size_t input,
                                         PyObject* object, double& value) const noexcept {
        return types_[input].read(numbers, object, value);
    }

  private:
    std::vector<nb::str> names_;   // interned, in the order of the inputs
    nb::dict places_;              // from name to index
    std::vector<ValueType> types_; // in the order of the inputs
    nb::object ignored_;
};

} // namespace rtamt::python
