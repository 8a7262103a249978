// The results of EarlyMonitor, and its state.
#include "early_monitor.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <stdexcept>
#include <variant>

namespace rtamt::python {

using early::Decision;
using early::Tick;

namespace {

[[nodiscard]] std::pair<double, double> pair_of(const Bounds& bounds) {
    return {bounds.lower, bounds.upper};
}

[[nodiscard]] std::optional<std::pair<double, double>>
pair_of(const std::optional<Bounds>& bounds) {
    if (!bounds) return std::nullopt;
    return pair_of(*bounds);
}

} // namespace

// ---- results ------------------------------------------------------------------------------------

PyObject* EarlyMonitor::result(PyObject* now) const noexcept {
    if (settings_.verdict) return decided(0, now);
    if (settings_.causation && !finished()) {
        return made_of(*settings_.causation, monitor_.caused_at_start());
    }
    Py_RETURN_NONE;
}

// Verdicts share the time of the newest sample, which nearly all of one call have.
PyObject* EarlyMonitor::decided(std::size_t output, PyObject* now) const noexcept {
    Py_ssize_t count = 0;
    const std::vector<Decision>& decisions = monitor_.decisions(output);
    for (const Decision& decision : decisions)
        count += decision.r - decision.l + 1;
    auto list = nb::steal(PyList_New(count));
    if (!list.is_valid()) return nullptr;
    const Tick newest = monitor_.newest();
    nb::object latest = nb::borrow(now);
    const auto moment = [&](Tick t) -> nb::object {
        if (t != newest) return nb::steal(PyFloat_FromDouble(monitor_.time(t)));
        if (!latest.is_valid()) latest = nb::steal(PyFloat_FromDouble(monitor_.time(t)));
        return latest;
    };
    Py_ssize_t place = 0;
    for (const Decision& decision : decisions) {
        const nb::object at = moment(decision.at);
        for (Tick t = decision.l; t <= decision.r; ++t) {
            PyObject* one = settings_.verdict->make(
                {moment(t), nb::borrow(decision.satisfied ? Py_True : Py_False), at});
            if (one == nullptr) return nullptr;
            fill_list(list.ptr(), place++, one);
        }
    }
    return list.release().ptr();
}

void EarlyMonitor::require_output(std::size_t output) const {
    if (output >= monitor_.outputs()) throw std::out_of_range("There is no such output.");
}

nb::object EarlyMonitor::verdicts(std::size_t output) {
    guard_.require_idle();
    require_output(output);
    return checked(decided(output));
}

std::optional<std::pair<double, double>> EarlyMonitor::at_start() const {
    return pair_of(monitor_.at_start());
}

std::optional<std::pair<double, double>> EarlyMonitor::bounds(std::size_t output,
                                                              Tick sample) const {
    require_output(output);
    return pair_of(monitor_.bounds(output, sample));
}

Tick EarlyMonitor::held(std::size_t output) const {
    require_output(output);
    return monitor_.held(output);
}

std::vector<std::tuple<Tick, Tick, double, double>>
EarlyMonitor::changes(std::size_t output) const {
    require_output(output);
    std::vector<std::tuple<Tick, Tick, double, double>> result;
    for (const early::BoundChange& run : monitor_.changes(output))
        result.emplace_back(run.l, run.r, run.bounds.lower, run.bounds.upper);
    return result;
}

nb::object EarlyMonitor::reported(std::size_t output) const {
    require_output(output);
    const auto runs = monitor_.changes(output);
    auto list = nb::steal(PyList_New(static_cast<Py_ssize_t>(runs.size())));
    if (!list.is_valid()) throw nb::python_error();
    Py_ssize_t place = 0;
    for (const early::BoundChange& run : runs) {
        PyObject* change = settings_.change.value().make(
            monitor_.time(run.l), monitor_.time(run.r), run.bounds, monitor_.is_final(output, run));
        if (change == nullptr) throw nb::python_error();
        fill_list(list.ptr(), place++, change);
    }
    return list;
}

nb::object EarlyMonitor::supposed(
    std::optional<std::size_t> output, Tick sample,
    const std::vector<std::tuple<Tick, Tick, std::vector<double>, std::vector<double>>>& later) {
    guard_.require_idle();
    if (output) require_output(*output);
    if (output && sample < monitor_.held(*output)) return nb::none();
    const Tick next = newest() + 1;
    std::vector<early::DiscreteMonitor::Supposition> suppositions;
    for (const auto& [first, last, lower, upper] : later) {
        if (lower.size() != row_.size() || upper.size() != row_.size() || first < 0) {
            throw std::invalid_argument("There is a bound of every input.");
        }
        early::DiscreteMonitor::Supposition supposed{next + first, early::plus(next, last), {}};
        for (std::size_t i = 0; i < lower.size(); ++i)
            supposed.row.push_back({lower[i], upper[i]});
        suppositions.push_back(std::move(supposed));
    }
    const auto found = monitor_.supposed(output, sample, suppositions);
    if (const auto* failure = std::get_if<Failure>(&found)) {
        const Tick t = failure->tick;
        return checked(fail(*failure, t, next > 0 ? monitor_.time(t) : static_cast<double>(t)));
    }
    const auto& value = std::get<Bounds>(found);
    return nb::make_tuple(value.lower, value.upper);
}

std::pair<double, double> EarlyMonitor::causation_at_start() const {
    return caused_of(monitor_.caused_at_start());
}

std::pair<double, double> EarlyMonitor::causation(std::size_t output, Tick sample) const {
    require_output(output);
    return caused_of(monitor_.caused(output, sample));
}

std::vector<std::tuple<Tick, Tick, double, double>> EarlyMonitor::caused(std::size_t output) const {
    require_output(output);
    std::vector<std::tuple<Tick, Tick, double, double>> result;
    for (const early::BoundChange& run : monitor_.caused(output)) {
        const auto [violation, satisfaction] = caused_of(run.bounds);
        result.emplace_back(run.l, run.r, violation, satisfaction);
    }
    return result;
}

std::optional<Tick> EarlyMonitor::place(double time) const {
    return monitor_.place(time);
}

std::pair<double, double> EarlyMonitor::known(std::uint32_t input, Tick sample) const {
    if (input >= row_.size()) throw std::out_of_range("There is no such input.");
    return pair_of(monitor_.known(input, sample));
}

double EarlyMonitor::time(Tick sample) const {
    if (newest() < 0) throw std::out_of_range("There is no sample.");
    return monitor_.time(sample);
}

// ---- state --------------------------------------------------------------------------------------

nb::bytes EarlyMonitor::state() {
    guard_.require_idle();
    monitor_.settle();
    Snapshot snapshot;
    monitor_.transfer(snapshot);
    return bytes_of(snapshot);
}

void EarlyMonitor::restore(const nb::bytes& state) {
    guard_.require_idle();
    Snapshot snapshot = snapshot_of(state);
    monitor_.transfer(snapshot);
    snapshot.end();
}

} // namespace rtamt::python
