// What the monitors of verdicts and bounds before the horizon have in common, as Python sees them.
#pragma once

#include "../early/origin.hpp"
#include "names.hpp"

#include <nanobind/nanobind.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

namespace rtamt::python {

// (opcode, a, b, x); operands that are not there are `early::none`.
using EarlyStep = std::tuple<int, std::uint32_t, std::uint32_t, double>;
// (kind, a, b, low, high, horizon, steps)
using EarlyNode = std::tuple<int, std::uint32_t, std::uint32_t, early::Tick, early::Tick,
                             early::Tick, std::vector<EarlyStep>>;
// (kind, negated, a, b, c, tick)
using EarlyItem = std::tuple<int, bool, std::uint32_t, std::uint32_t, std::uint32_t, early::Tick>;

[[nodiscard]] early::Graph graph_of(const std::vector<EarlyNode>& nodes, std::uint32_t inputs);
[[nodiscard]] std::vector<early::Item> items_of(const std::vector<EarlyItem>& items);
[[nodiscard]] std::vector<Bounds> bounds_of(const std::vector<std::pair<double, double>>& pairs);

// Of each node, how many steps of others come before its own.
[[nodiscard]] std::vector<std::uint32_t> steps_before(const early::Graph& graph);

class EarlyBackend {
  public:
    EarlyBackend() = default;
    EarlyBackend(const EarlyBackend&) = delete;
    EarlyBackend& operator=(const EarlyBackend&) = delete;
    EarlyBackend(EarlyBackend&&) = delete;
    EarlyBackend& operator=(EarlyBackend&&) = delete;
    virtual ~EarlyBackend() = default;

    // A list of verdicts, or None; null, with a Python exception set, is a refusal.
    [[nodiscard]] virtual PyObject* update(PyObject* time, const Named& values) noexcept = 0;
};

// A class of objects with slots, which are filled without a call of Python code.
template <std::size_t count>
class ResultClass {
  public:
    ResultClass(const nb::object& type, const std::array<const char*, count>& slots) : type_(type) {
        for (std::size_t i = 0; i < count; ++i)
            slots_[i] = type.attr(slots[i]);
    }

    // Null, with a Python exception set, where that fails.
    [[nodiscard]] PyObject* make(const std::array<nb::object, count>& values) const noexcept {
        auto* type = reinterpret_cast<PyTypeObject*>(type_.ptr());
        auto made = nb::steal(type->tp_alloc(type, 0));
        if (!made.is_valid()) return nullptr;
        for (std::size_t i = 0; i < count; ++i) {
            PyObject* slot = slots_[i].ptr();
            if (!values[i].is_valid()) return nullptr;
            if (Py_TYPE(slot)->tp_descr_set(slot, made.ptr(), values[i].ptr()) != 0) return nullptr;
        }
        return made.release().ptr();
    }

  private:
    nb::object type_;
    std::array<nb::object, count> slots_; // descriptors
};

} // namespace rtamt::python
