#include "dense_early_monitor.hpp"

#include "arrays.hpp"
#include "numbers.hpp"
#include "ticks.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <new>
#include <stdexcept>
#include <variant>

namespace rtamt::python {

using early::forever;
using early::Tick;

namespace {

// The value for no tick; NEVER in compiler/early.py.
constexpr Tick never = -forever;

[[nodiscard]] std::vector<std::tuple<Tick, Tick, double, double>>
tuples_of(const std::vector<early::BoundChange>& runs) {
    std::vector<std::tuple<Tick, Tick, double, double>> result;
    result.reserve(runs.size());
    for (const early::BoundChange& run : runs)
        result.emplace_back(run.l, run.r + 1, run.bounds.lower, run.bounds.upper);
    return result;
}

[[nodiscard]] std::pair<double, double> pair_of(const Bounds& bounds) {
    return {bounds.lower, bounds.upper};
}

} // namespace

DenseEarlyMonitor::DenseEarlyMonitor(early::DenseRequirements monitor,
                                     std::vector<std::vector<std::uint32_t>> steps_before,
                                     Settings settings, const std::vector<nb::str>& names,
                                     const nb::object& ignored, const nb::dict& types,
                                     Exceptions exceptions)
    : monitor_(std::move(monitor)), settings_(std::move(settings)),
      exceptions_(std::move(exceptions)), guard_(exceptions_.refused, exceptions_.in_use),
      names_(names, static_cast<std::uint32_t>(names.size()), ignored, types),
      steps_before_(std::move(steps_before)), counts_(names.size()) {
    settings_.ranges.resize(names.size(), bounds::anything);
}

void DenseEarlyMonitor::set_time_scale(const nb::object& verdict, double rate) {
    guard_.require_idle();
    verdict_.emplace(verdict, std::array{"begin", "end", "satisfied", "decided_at"});
    rate_ = rate;
}

// ---- samples ------------------------------------------------------------------------------------

// Reads plain numbers, which runs no Python code; if not, a Python exception is set.
bool DenseEarlyMonitor::takes(PyObject* time, const Named& values, Tick& tick) noexcept {
    if (!guard_.open(finished())) return false;
    if (settings_.replays) return guard_.refuse("replays") != nullptr;
    const auto read = rate_ > 0 ? tick_of(time, rate_, false) : std::nullopt;
    if (!read || std::fabs(static_cast<double>(*read)) >= near) {
        return guard_.refuse("time") != nullptr;
    }
    tick = *read;
    given_.clear();
    std::size_t guess = 0;
    const char* wrong = values.each([&](PyObject* name, PyObject* value) -> const char* {
        const auto place = names_.place(name, guess, true);
        if (!place) return names_.ignored(name, true) ? nullptr : "names";
        guess = *place + 1;
        double x = 0;
        if (!names_.read(PlainNumbers{}, *place, value, x)) return "value";
        const auto input = static_cast<std::uint32_t>(*place);
        if (!monitor_.may_come(input, tick)) return "time";
        const Bounds known = settings_.late ? monitor_.known(input, tick) : settings_.ranges[input];
        if (known.lower > x || x > known.upper) return "range";
        given_.push_back({input, {x, x}});
        return nullptr;
    });
    if (wrong == nullptr && given_.empty()) wrong = "time"; // which Python checks
    return wrong == nullptr || guard_.refuse(wrong) != nullptr;
}

PyObject* DenseEarlyMonitor::update(PyObject* time, const Named& values) noexcept {
    Tick tick = 0;
    if (!takes(time, values, tick)) return nullptr;
    try {
        if (const auto failure = monitor_.take(tick, given_)) return fail(*failure);
        for (const auto& each : given_)
            ++counts_[each.input];
    } catch (const std::bad_alloc&) {
        return PyErr_NoMemory();
    }
    if (settings_.decides) return new_data();
    if (settings_.causation) return made_of(*settings_.causation, monitor_.caused_at_start());
    Py_RETURN_NONE;
}

void DenseEarlyMonitor::learn(Tick tick,
                              const std::vector<std::tuple<std::uint32_t, double, double>>& values,
                              std::int64_t after) {
    guard_.require_idle();
    guard_.require(after == samples() && !finished());
    given_.clear();
    for (const auto& [input, lower, upper] : values) {
        if (input >= settings_.ranges.size()) throw std::out_of_range("There is no such input.");
        if (!monitor_.may_come(input, tick)) {
            (void)guard_.refuse("order");
            throw nb::python_error();
        }
        given_.push_back({input, {lower, upper}});
    }
    check(monitor_.take(tick, given_));
    for (const auto& each : given_)
        ++counts_[each.input];
}

void DenseEarlyMonitor::watermark(Tick tick) {
    guard_.require_idle();
    guard_.require(!finished());
    check(monitor_.watermark(tick));
}

void DenseEarlyMonitor::finish() {
    guard_.require_idle();
    guard_.require(!finished());
    check(monitor_.finish());
}

// The operation of a step by its number in the whole graph, and the tick.
PyObject* DenseEarlyMonitor::fail(const Failure& failure) const noexcept {
    const auto& [node, step, tick] = failure.operation;
    const auto raised = nb::steal(PyObject_CallFunction(exceptions_.undefined.ptr(), "IL",
                                                        steps_before_[failure.group][node] + step,
                                                        static_cast<long long>(tick)));
    if (raised.is_valid()) PyErr_SetObject(exceptions_.undefined.ptr(), raised.ptr());
    return nullptr;
}

void DenseEarlyMonitor::check(const std::optional<Failure>& failure) const {
    if (!failure) return;
    (void)fail(*failure);
    throw nb::python_error();
}

// ---- results ------------------------------------------------------------------------------------

// The verdicts of the first output, in the times of the caller.
PyObject* DenseEarlyMonitor::new_data() const noexcept {
    const auto& decisions = monitor_.decisions(0);
    auto list = nb::steal(PyList_New(static_cast<Py_ssize_t>(decisions.size())));
    if (!list.is_valid()) return nullptr;
    const auto time = [&](Tick tick) {
        return nb::steal(PyFloat_FromDouble(static_cast<double>(tick) / rate_));
    };
    Py_ssize_t place = 0;
    for (const early::Decision& each : decisions) {
        PyObject* made =
            verdict_->make({time(each.l), time(each.r + 1),
                            nb::borrow(each.satisfied ? Py_True : Py_False), time(each.at)});
        if (made == nullptr) return nullptr;
        fill_list(list.ptr(), place++, made);
    }
    return list.release().ptr();
}

void DenseEarlyMonitor::require_output(std::size_t output) const {
    guard_.require_idle();
    if (output >= monitor_.outputs()) throw std::out_of_range("There is no such output.");
}

std::vector<std::tuple<Tick, Tick, bool, Tick>>
DenseEarlyMonitor::verdicts(std::size_t output) const {
    require_output(output);
    std::vector<std::tuple<Tick, Tick, bool, Tick>> result;
    for (const early::Decision& each : monitor_.decisions(output))
        result.emplace_back(each.l, each.r + 1, each.satisfied, each.at);
    return result;
}

DenseEarlyMonitor::Runs DenseEarlyMonitor::changes(std::size_t output) {
    require_output(output);
    return tuples_of(monitor_.changes(output));
}

DenseEarlyMonitor::Runs DenseEarlyMonitor::runs(std::size_t output) {
    require_output(output);
    return tuples_of(monitor_.runs(output));
}

std::optional<std::pair<double, double>> DenseEarlyMonitor::at_start() {
    const auto bounds = monitor_.at_start();
    if (!bounds) return std::nullopt;
    return pair_of(*bounds);
}

std::optional<std::pair<double, double>> DenseEarlyMonitor::bounds(std::size_t output, Tick tick) {
    require_output(output);
    const auto bounds = monitor_.at(output, tick);
    if (!bounds) return std::nullopt;
    return pair_of(*bounds);
}

std::optional<std::pair<double, double>> DenseEarlyMonitor::supposed(
    std::optional<std::size_t> output, Tick tick,
    const std::vector<std::tuple<std::uint32_t, Tick, double, double>>& later) {
    guard_.require_idle();
    if (output) require_output(*output);
    std::vector<early::DenseMonitor::Supposed> supposed;
    for (const auto& [input, from, lower, upper] : later) {
        if (input >= settings_.ranges.size()) throw std::out_of_range("There is no such input.");
        supposed.push_back({input, from, {lower, upper}});
    }
    const auto found = monitor_.suppose(output, tick, supposed);
    if (const auto* failure = std::get_if<Failure>(&found)) check(*failure);
    const auto& value = std::get<std::optional<Bounds>>(found);
    if (!value) return std::nullopt;
    return pair_of(*value);
}

std::pair<double, double> DenseEarlyMonitor::causation_at_start() {
    return caused_of(monitor_.caused_at_start());
}

std::optional<std::pair<double, double>>
DenseEarlyMonitor::causation(std::size_t output, std::optional<Tick> tick) const {
    require_output(output);
    const auto caused = monitor_.caused(output, tick);
    if (!caused) return std::nullopt;
    return caused_of(*caused);
}

DenseEarlyMonitor::Runs DenseEarlyMonitor::caused(std::size_t output) const {
    require_output(output);
    Runs result;
    for (const early::BoundChange& run : monitor_.caused(output)) {
        const auto [violation, satisfaction] = caused_of(run.bounds);
        result.emplace_back(run.l, early::plus(run.r, 1), violation, satisfaction);
    }
    return result;
}

std::pair<double, double> DenseEarlyMonitor::known(std::uint32_t input, Tick tick) const {
    if (input >= settings_.ranges.size()) throw std::out_of_range("There is no such input.");
    return pair_of(monitor_.known(input, tick));
}

std::optional<Tick> DenseEarlyMonitor::held(std::size_t output) const {
    require_output(output);
    return monitor_.held(output);
}

std::int64_t DenseEarlyMonitor::samples() const {
    std::int64_t sum = 0;
    for (const std::int64_t count : counts_)
        sum += count;
    return sum;
}

std::vector<Tick> DenseEarlyMonitor::last_times() const {
    std::vector<Tick> times;
    times.reserve(counts_.size());
    for (std::uint32_t input = 0; input < counts_.size(); ++input)
        times.push_back(monitor_.newest(input).value_or(never));
    return times;
}

Tick DenseEarlyMonitor::newest() const {
    return monitor_.newest().value_or(never);
}

Tick DenseEarlyMonitor::closed() const {
    return monitor_.closed().value_or(never);
}

Tick DenseEarlyMonitor::complete() const {
    return monitor_.complete().value_or(never);
}

// ---- state --------------------------------------------------------------------------------------

nb::bytes DenseEarlyMonitor::state() {
    guard_.require_idle();
    Snapshot snapshot;
    transfer(snapshot);
    return bytes_of(snapshot);
}

void DenseEarlyMonitor::restore(const nb::bytes& state) {
    guard_.require_idle();
    Snapshot snapshot = snapshot_of(state);
    transfer(snapshot);
    snapshot.end();
}

void DenseEarlyMonitor::transfer(Snapshot& snapshot) {
    monitor_.transfer(snapshot);
    snapshot.values(counts_.data(), counts_.size());
    for (const std::int64_t count : counts_)
        snapshot.require(count >= 0 && count < early::forever);
}

} // namespace rtamt::python
