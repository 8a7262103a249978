// The class DenseEarlyMonitor of the extension module.
#include "dense_early_monitor.hpp"
#include "locked_class.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <cstdint>
#include <new>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

namespace rtamt::python {

using early::Tick;

namespace {

// (nodes, outputs, at_start, inputs, causes)
using EarlyGroup =
    std::tuple<std::vector<EarlyNode>, std::vector<std::uint32_t>, std::vector<EarlyItem>,
               std::vector<std::uint32_t>, std::optional<EarlyCauses>>;

} // namespace

void add_dense_early_monitor(const nb::module_& module, const Exceptions& exceptions) {
    LockedClass<DenseEarlyMonitor, EarlyBackend>(
        module, "DenseEarlyMonitor", "Verdicts or bounds before the horizon, in dense time.")
        .def(
            "__init__",
            [exceptions](
                DenseEarlyMonitor* self, const std::vector<EarlyGroup>& groups,
                std::size_t required,
                const std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>>& outputs,
                const std::vector<std::pair<double, double>>& ranges,
                const std::vector<nb::str>& names, const nb::object& ignored, const nb::dict& types,
                std::optional<Tick> lateness, bool verdicts, bool replays) {
                DenseEarlyMonitor::Settings settings{bounds_of(ranges), lateness.has_value(),
                                                     verdicts, replays, std::nullopt};
                std::vector<early::DenseRequirements::Group> all;
                std::vector<std::vector<std::uint32_t>> steps;
                std::uint32_t before = 0;
                for (const auto& [nodes, refs, at_start, inputs, causes] : groups) {
                    const auto count = static_cast<std::uint32_t>(inputs.size());
                    early::DenseSettings own{refs, items_of(at_start), {}, lateness, verdicts, {}};
                    for (const std::uint32_t input : inputs)
                        own.ranges.push_back(settings.ranges.at(input));
                    if (causes) {
                        own.causes = causes_of(*causes);
                        settings.causation.emplace(causation_of(*causes));
                    }
                    all.push_back({graph_of(nodes, count), std::move(own), inputs});
                    steps.push_back(steps_before(all.back().graph, before));
                }
                std::vector<std::vector<early::DenseRequirements::Place>> places;
                for (const auto& each : outputs) {
                    auto& own = places.emplace_back();
                    for (const auto& [group, output] : each)
                        own.push_back({group, output});
                }
                new (self) DenseEarlyMonitor(
                    early::DenseRequirements(std::move(all), required, places), std::move(steps),
                    std::move(settings), names, ignored, types, exceptions);
            },
            nb::arg("groups"), nb::arg("required"), nb::arg("outputs"), nb::arg("ranges"),
            nb::arg("names"), nb::arg("ignored").none(), nb::arg("types"),
            nb::arg("lateness").none(), nb::arg("verdicts"), nb::arg("replays") = false)
        .def("set_time_scale", &DenseEarlyMonitor::set_time_scale, nb::arg("verdict"),
             nb::arg("rate"), "Let update() take numbers of so many ticks each.")
        .def("learn", &DenseEarlyMonitor::learn, nb::arg("tick"), nb::arg("values"),
             nb::arg("after"), "Take bounds (input, lower, upper) of some inputs at one tick.")
        .def("watermark", &DenseEarlyMonitor::watermark, nb::arg("tick"),
             "Nothing at or before a tick will come.")
        .def("finish", &DenseEarlyMonitor::finish, "End the trace: every input holds its value.")
        .def("verdicts", &DenseEarlyMonitor::verdicts, nb::arg("output"),
             "Runs (begin, end, satisfied, decided at) that the last call decided or reached.")
        .def("changes", &DenseEarlyMonitor::changes, nb::arg("output"),
             "Runs (begin, end, lower, upper) that the last call changed.")
        .def("runs", &DenseEarlyMonitor::runs, nb::arg("output"),
             "All runs that are held, up to the newest sample.")
        .def("at_start", &DenseEarlyMonitor::at_start, "The bounds at the start of the trace.")
        .def("bounds", &DenseEarlyMonitor::bounds, nb::arg("output"), nb::arg("tick"),
             "The bounds of an output at a tick, None where they are not held.")
        .def("supposed", &DenseEarlyMonitor::supposed, nb::arg("output").none(), nb::arg("tick"),
             nb::arg("later"),
             "The bounds of an output, or at the start, if inputs had such bounds from ticks on.")
        .def("causation_at_start", &DenseEarlyMonitor::causation_at_start,
             "Violation and satisfaction that the last call caused at the start of the trace.")
        .def("causation", &DenseEarlyMonitor::causation, nb::arg("output"), nb::arg("tick").none(),
             "The same of an output at a tick, or at the start; None before the trace.")
        .def("caused", &DenseEarlyMonitor::caused, nb::arg("output"),
             "The same as runs (begin, end, violation, satisfaction), where there is any.")
        .def("known", &DenseEarlyMonitor::known, nb::arg("number"), nb::arg("tick"),
             "What is known of an input at a tick.")
        .def(
            "place", [](const DenseEarlyMonitor& /*self*/, Tick tick) { return tick; },
            nb::arg("tick"), "The position of a time, which is the tick itself.")
        .def("held", &DenseEarlyMonitor::held, nb::arg("output"),
             "The first tick that is held, None before the trace has started.")
        .def("state", &DenseEarlyMonitor::state, "What the samples so far have left behind.")
        .def("restore", &DenseEarlyMonitor::restore, nb::arg("state"),
             "Go on as the monitor of this state would, which was made like this one.")
        .def_prop_ro("samples", &DenseEarlyMonitor::samples, "How many samples of any input came.")
        .def_prop_ro("counts", &DenseEarlyMonitor::counts, "The same of each input.")
        .def_prop_ro("last_times", &DenseEarlyMonitor::last_times,
                     "The tick of the newest sample of each input.")
        .def_prop_ro("newest", &DenseEarlyMonitor::newest,
                     "The tick of the newest sample of any input.")
        .def_prop_ro("closed", &DenseEarlyMonitor::closed,
                     "The last tick at or before which no sample will come.")
        .def_prop_ro("complete", &DenseEarlyMonitor::complete,
                     "The tick up to which all inputs are as well known as they will ever be.")
        .def_prop_ro("finished", &DenseEarlyMonitor::finished, "Whether the trace has ended.")
        .def_prop_ro("state_bytes", &DenseEarlyMonitor::state_bytes, "Bytes of state by now.");
}

} // namespace rtamt::python
