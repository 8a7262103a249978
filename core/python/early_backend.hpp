// What the monitors of verdicts and bounds before the horizon have in common, as Python sees them.
#pragma once

#include "../early/origin.hpp"
#include "names.hpp"
#include "result_class.hpp"

#include <nanobind/nanobind.h>

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

} // namespace rtamt::python
