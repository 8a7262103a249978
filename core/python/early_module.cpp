// The class EarlyMonitor of the extension module, and what it shares with that of dense time.
#include "early_monitor.hpp"
#include "locked_class.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <new>

namespace rtamt::python {

using early::Tick;

early::Graph graph_of(const std::vector<EarlyNode>& nodes, std::uint32_t inputs) {
    early::Graph graph;
    graph.inputs = inputs;
    for (const auto& [kind, a, b, low, high, horizon, steps] : nodes) {
        early::Node node{static_cast<early::Kind>(kind), a, b, low, high, horizon, {}};
        for (const auto& [opcode, first, second, x] : steps)
            node.steps.push_back({static_cast<Opcode>(opcode), first, second, x});
        graph.nodes.push_back(std::move(node));
    }
    graph.check();
    return graph;
}

std::vector<early::Item> items_of(const std::vector<EarlyItem>& items) {
    std::vector<early::Item> result;
    result.reserve(items.size());
    for (const auto& [kind, negated, a, b, c, tick] : items)
        result.push_back({static_cast<early::Item::Kind>(kind), negated, a, b, c, tick});
    return result;
}

std::vector<Bounds> bounds_of(const std::vector<std::pair<double, double>>& pairs) {
    std::vector<Bounds> result;
    result.reserve(pairs.size());
    for (const auto& [lower, upper] : pairs)
        result.push_back({lower, upper});
    return result;
}

early::CauseGraph causes_of(const EarlyCauses& causes) {
    early::CauseGraph graph;
    for (const auto& [kind, ref, a, b, low, high, shift, core] : std::get<0>(causes)) {
        const auto known = static_cast<early::Cause::Kind>(kind);
        graph.parts.push_back({known, ref, a, b, low, high, shift, core});
    }
    graph.outputs = std::get<1>(causes);
    for (const auto& [a, b, before, rest] : std::get<2>(causes))
        graph.starts.push_back({a, b, before, rest});
    return graph;
}

ResultClass<2> causation_of(const EarlyCauses& causes) {
    return {std::get<3>(causes), std::array{"violation", "satisfaction"}};
}

std::pair<double, double> caused_of(const Bounds& caused) {
    return {caused.upper + 0.0, caused.lower + 0.0};
}

PyObject* made_of(const ResultClass<2>& causation, const Bounds& caused) noexcept {
    return causation.make({nb::steal(PyFloat_FromDouble(caused.upper + 0.0)),
                           nb::steal(PyFloat_FromDouble(caused.lower + 0.0))});
}

std::vector<std::uint32_t> steps_before(const early::Graph& graph, std::uint32_t& before) {
    std::vector<std::uint32_t> result;
    for (const early::Node& node : graph.nodes) {
        result.push_back(before);
        before += static_cast<std::uint32_t>(node.steps.size());
    }
    return result;
}

void add_early_monitor(const nb::module_& module, const Exceptions& exceptions) {
    const nb::class_<EarlyBackend> base(module, "_EarlyBackend",
                                        "Takes samples for early verdicts.");
    LockedClass<EarlyMonitor, EarlyBackend>(
        module, "EarlyMonitor", "Verdicts or bounds before the horizon, in discrete time.")
        .def(
            "__init__",
            [exceptions](
                EarlyMonitor* self, const std::vector<EarlyNode>& nodes,
                std::vector<std::uint32_t> outputs, const std::vector<EarlyItem>& at_start,
                const std::vector<std::pair<double, double>>& ranges,
                const std::vector<nb::str>& names, const nb::object& ignored, const nb::dict& types,
                double period, double tolerance, std::optional<Tick> lateness,
                const nb::object& verdict, bool replays, const std::optional<EarlyCauses>& causes,
                const std::optional<std::pair<nb::object, nb::object>>& change, Tick zone) {
                early::DiscreteSettings own{
                    std::move(outputs), items_of(at_start), bounds_of(ranges), period, tolerance,
                    lateness,           !verdict.is_none(), std::nullopt,      zone};
                EarlyMonitor::Settings settings{replays, std::nullopt, std::nullopt, std::nullopt};
                if (!verdict.is_none()) {
                    settings.verdict.emplace(verdict,
                                             std::array{"time", "satisfied", "decided_at"});
                }
                if (causes) {
                    own.causes = causes_of(*causes);
                    settings.causation.emplace(causation_of(*causes));
                }
                if (change) settings.change.emplace(change->first, change->second);
                new (self) EarlyMonitor(graph_of(nodes, static_cast<std::uint32_t>(names.size())),
                                        std::move(own), names, ignored, types, std::move(settings),
                                        exceptions);
            },
            nb::arg("nodes"), nb::arg("outputs"), nb::arg("at_start"), nb::arg("ranges"),
            nb::arg("names"), nb::arg("ignored"), nb::arg("types"), nb::arg("period"),
            nb::arg("tolerance"), nb::arg("lateness").none(), nb::arg("verdict").none(),
            nb::arg("replays") = false, nb::arg("causes").none() = nb::none(),
            nb::arg("change").none() = nb::none(), nb::arg("zone") = early::ZoneEngine::crossover)
        .def("take", &EarlyMonitor::take, nb::arg("time"), nb::arg("lower"), nb::arg("upper"),
             nb::arg("after"), "Take bounds of every input at one time, in order.")
        .def("learn", &EarlyMonitor::learn, nb::arg("time"), nb::arg("values"), nb::arg("after"),
             "Take bounds (input, lower, upper) of some inputs at one time.")
        .def("watermark", &EarlyMonitor::watermark, nb::arg("time"),
             "Nothing at or before a time will come.")
        .def("finish", &EarlyMonitor::finish, "End the trace; return what that makes known.")
        .def("verdicts", &EarlyMonitor::verdicts, nb::arg("output"),
             "The verdicts of an output that the last call decided.")
        .def("at_start", &EarlyMonitor::at_start, "The bounds at the start of the trace.")
        .def("bounds", &EarlyMonitor::bounds, nb::arg("output"), nb::arg("sample"),
             "The bounds of an output at a sample, None where they are forgotten.")
        .def("changes", &EarlyMonitor::changes, nb::arg("output"),
             "Runs (first, last, lower, upper) that the last call changed.")
        .def("reported", &EarlyMonitor::reported, nb::arg("output"),
             "The same as a list of objects with times.")
        .def("supposed", &EarlyMonitor::supposed, nb::arg("output").none(), nb::arg("sample"),
             nb::arg("later"), "The bounds if later samples had these bounds of all inputs.")
        .def("causation_at_start", &EarlyMonitor::causation_at_start,
             "Violation and satisfaction that the newest sample causes at the start of the trace.")
        .def("causation", &EarlyMonitor::causation, nb::arg("output"), nb::arg("sample"),
             "Violation and satisfaction that the newest sample causes for an output at a sample.")
        .def("caused", &EarlyMonitor::caused, nb::arg("output"),
             "The same as runs (first, last, violation, satisfaction), where there is any.")
        .def("begin_at", &EarlyMonitor::begin_at, nb::arg("sample"),
             "Number the first sample, so that earlier ones may follow. Return False where it must "
             "be 0.")
        .def("place", &EarlyMonitor::place, nb::arg("time"), "The index of a time, or None.")
        .def("known", &EarlyMonitor::known, nb::arg("variable"), nb::arg("sample"),
             "What is known of an input at a sample.")
        .def("time", &EarlyMonitor::time, nb::arg("sample"), "The time of a sample.")
        .def("held", &EarlyMonitor::held, nb::arg("output"), "The first sample that is held.")
        .def("state", &EarlyMonitor::state, "What the samples so far have left behind.")
        .def("restore", &EarlyMonitor::restore, nb::arg("state"),
             "Go on as the monitor of this state would, which was made like this one.")
        .def_prop_ro("samples", &EarlyMonitor::samples, "How many samples came.")
        .def_prop_ro("newest", &EarlyMonitor::newest, "The newest sample, or -1.")
        .def_prop_ro("earliest", &EarlyMonitor::earliest, "The first time that may be reported.")
        .def_prop_ro("closed", &EarlyMonitor::closed, "The last sample that is final, or -1.")
        .def_prop_ro("finished", &EarlyMonitor::finished, "Whether the trace has ended.")
        .def_prop_ro("computes_zone", &EarlyMonitor::computes_zone,
                     "Whether it computes the bounds of all open samples anew.")
        .def_prop_ro("state_bytes", &EarlyMonitor::state_bytes, "Bytes of state by now.");
}

} // namespace rtamt::python
