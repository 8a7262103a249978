#include "early_monitor.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <cmath>
#include <span>
#include <stdexcept>
#include <variant>

namespace rtamt::python {

using early::Tick;

EarlyMonitor::EarlyMonitor(const early::Graph& graph, early::DiscreteSettings monitor,
                           const std::vector<nb::str>& names, const nb::object& ignored,
                           const nb::dict& types, Settings settings, Exceptions exceptions)
    : monitor_(graph, std::move(monitor)), settings_(std::move(settings)),
      exceptions_(std::move(exceptions)), guard_(exceptions_.refused, exceptions_.in_use),
      names_(names, graph.inputs, ignored, types), row_(graph.inputs) {
    std::uint32_t before = 0;
    steps_before_ = steps_before(graph, before);
}

// ---- samples ------------------------------------------------------------------------------------

PyObject* EarlyMonitor::update(PyObject* time, const Named& values) noexcept {
    if (!guard_.open(finished())) return nullptr;
    if (settings_.replays) return guard_.refuse("replays");
    double t = 0.0;
    if (!numbers_.read(time, t) || std::fabs(t) >= implausible) return guard_.refuse("time");
    const auto index = monitor_.place(t);
    if (!index) return guard_.refuse("time");
    const bool late = monitor_.late();
    if (late && newest() < 0) return guard_.refuse("first");
    if (!late && (!monitor_.in_order(*index) || values.count() != names_.count())) {
        return guard_.refuse("order");
    }
    std::size_t guess = 0;
    observations_.clear();
    const char* wrong = values.each([&](PyObject* name, PyObject* value) -> const char* {
        const auto input = names_.place(name, guess++, true);
        if (!input) return "names";
        if (!names_.read(numbers_, *input, value, row_[*input])) return "value";
        const double x = row_[*input];
        if (late) {
            const Bounds known = monitor_.known(static_cast<std::uint32_t>(*input), *index);
            if (known.lower > x || x > known.upper) return "contradiction";
            observations_.push_back({static_cast<std::uint32_t>(*input), *index, *index, {x, x}});
        } else if (monitor_.ranges()[*input].lower > x || x > monitor_.ranges()[*input].upper) {
            return "range";
        }
        return nullptr;
    });
    if (wrong != nullptr) return guard_.refuse(wrong);
    if (late && *index <= closed()) return guard_.refuse("late");
    try {
        const auto failure = late ? monitor_.learn(*index, t, observations_)
                                  : monitor_.row(*index, t, std::span<const double>(row_));
        if (failure) return fail(*failure, *index, t);
        const bool latest = *index == newest() && PyFloat_CheckExact(time) != 0;
        return result(latest && t != 0.0 ? time : nullptr); // zero is reported without a sign
    } catch (const std::bad_alloc&) {
        return PyErr_NoMemory();
    }
}

void EarlyMonitor::require(std::int64_t after) {
    guard_.require_idle();
    guard_.require(after == samples() && !finished());
}

nb::object EarlyMonitor::checked(PyObject* result) const {
    if (result == nullptr) throw nb::python_error();
    return nb::steal(result);
}

nb::object EarlyMonitor::take(double time, const std::vector<double>& lower,
                              const std::vector<double>& upper, std::int64_t after) {
    require(after);
    const auto index = monitor_.place(time);
    if (!index || !monitor_.in_order(*index) || lower.size() != row_.size() ||
        upper.size() != row_.size()) {
        return checked(guard_.refuse("order"));
    }
    std::vector<Bounds> row;
    row.reserve(lower.size());
    for (std::size_t i = 0; i < lower.size(); ++i)
        row.push_back({lower[i], upper[i]});
    const auto failure = monitor_.row(*index, time, std::span<const Bounds>(row));
    return checked(failure ? fail(*failure, *index, time) : result());
}

nb::object EarlyMonitor::learn(double time,
                               const std::vector<std::tuple<std::uint32_t, double, double>>& values,
                               std::int64_t after) {
    require(after);
    const auto index = monitor_.place(time);
    if (!index || !monitor_.late() || *index <= closed()) return checked(guard_.refuse("late"));
    observations_.clear();
    for (const auto& [input, lower, upper] : values) {
        if (input >= row_.size()) throw std::out_of_range("There is no such input.");
        observations_.push_back({input, *index, *index, {lower, upper}});
    }
    const auto failure = monitor_.learn(*index, time, observations_);
    return checked(failure ? fail(*failure, *index, time) : result());
}

bool EarlyMonitor::begin_at(early::Tick sample) {
    guard_.require_idle();
    return sample >= 0 && sample < early::forever && monitor_.begin_at(sample);
}

nb::object EarlyMonitor::watermark(double time) {
    guard_.require_idle();
    if (const auto failure = monitor_.watermark(time)) {
        return checked(fail(*failure, newest(), monitor_.last_time()));
    }
    return nb::none();
}

// The operation of a step by its number in the whole graph, the sample and its time, from those of
// the sample that came.
PyObject* EarlyMonitor::fail(const Failure& failure, Tick index, double time) noexcept {
    const auto when = static_cast<long long>(failure.tick);
    const auto raised = nb::steal(PyObject_CallFunction(
        exceptions_.undefined.ptr(), "IL", steps_before_[failure.node] + failure.step, when));
    const auto steps = static_cast<double>(failure.tick - index);
    const auto seconds = nb::steal(PyFloat_FromDouble(time + steps * monitor_.period()));
    if (raised.is_valid() && seconds.is_valid() &&
        PyObject_SetAttrString(raised.ptr(), "time", seconds.ptr()) == 0) {
        PyErr_SetObject(exceptions_.undefined.ptr(), raised.ptr());
    }
    return nullptr;
}

nb::object EarlyMonitor::finish() {
    guard_.require_idle();
    const auto ended = monitor_.finish();
    if (const auto* failure = std::get_if<Failure>(&ended)) {
        return checked(fail(*failure, newest(), monitor_.last_time()));
    }
    if (settings_.verdict) return checked(result());
    const auto& end = std::get<early::DiscreteMonitor::End>(ended);
    nb::list all;
    for (const early::DiscreteMonitor::Rest& rest : end.outputs) {
        nb::list values;
        for (const Bounds& bounds : rest.bounds)
            values.append(nb::make_tuple(bounds.lower, bounds.upper));
        all.append(nb::make_tuple(rest.first, values));
    }
    nb::object start = nb::none();
    if (end.at_start) start = nb::make_tuple(end.at_start->lower, end.at_start->upper);
    return nb::make_tuple(all, start);
}

} // namespace rtamt::python
