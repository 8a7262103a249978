// The common base of the Python classes of early monitors: verdicts, bounds and causation.
#pragma once

#include "../early/bounds_at_start.hpp"
#include "../early/causation.hpp"
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
// (kind, ref, a, b, low, high, shift, core)
using EarlyCause = std::tuple<int, std::uint32_t, std::uint32_t, std::uint32_t, early::Tick,
                              early::Tick, early::Tick, std::uint32_t>;
// (a, b, before, rest)
using EarlyStart = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t>;
// Parts, outputs, starts, and the class of what update() returns.
using EarlyCauses = std::tuple<std::vector<EarlyCause>, std::vector<std::uint32_t>,
                               std::vector<EarlyStart>, nb::object>;

[[nodiscard]] early::Graph graph_of(const std::vector<EarlyNode>& nodes, std::uint32_t inputs);
[[nodiscard]] std::vector<early::Item> items_of(const std::vector<EarlyItem>& items);
[[nodiscard]] std::vector<Bounds> bounds_of(const std::vector<std::pair<double, double>>& pairs);
[[nodiscard]] early::CauseGraph causes_of(const EarlyCauses& causes);
// What update() returns, by the class of the causes; no minus before a zero.
[[nodiscard]] ResultClass<2> causation_of(const EarlyCauses& causes);
[[nodiscard]] std::pair<double, double> caused_of(const Bounds& caused);
[[nodiscard]] PyObject* made_of(const ResultClass<2>& causation, const Bounds& caused) noexcept;

// Of each node, how many steps of others come before its own, after those of other graphs.
[[nodiscard]] std::vector<std::uint32_t> steps_before(const early::Graph& graph,
                                                      std::uint32_t& before);

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
