// The results of EarlyMonitor, and its state.
#include "early_monitor.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <stdexcept>

namespace rtamt::python {

using early::Decision;
using early::forever;
using early::Tick;

// ---- results ------------------------------------------------------------------------------------

PyObject* EarlyMonitor::result() noexcept {
    if (settings_.verdict) return new_data(0);
    if (causation_ && !finished_) return made_of(*causation_, causes_->at_start());
    Py_RETURN_NONE;
}

PyObject* EarlyMonitor::new_data(std::size_t output) noexcept {
    Py_ssize_t count = 0;
    auto& decisions = news_[output];
    for (const Decision& decision : decisions)
        count += decision.r - decision.l + 1;
    if (decisions.size() > 1) std::ranges::sort(decisions, {}, &Decision::l);
    auto list = nb::steal(PyList_New(count));
    if (!list.is_valid()) return nullptr;
    Py_ssize_t place = 0;
    for (const Decision& decision : decisions) {
        for (Tick t = decision.l; t <= decision.r; ++t) {
            PyObject* one =
                settings_.verdict->make({nb::steal(PyFloat_FromDouble(times_.at(t))),
                                         nb::borrow(decision.satisfied ? Py_True : Py_False),
                                         nb::steal(PyFloat_FromDouble(times_.at(decision.at)))});
            if (one == nullptr) return nullptr;
            fill_list(list.ptr(), place++, one);
        }
    }
    return list.release().ptr();
}

nb::object EarlyMonitor::verdicts(std::size_t output) {
    guard_.require_idle();
    if (output >= outputs_.size()) throw std::out_of_range("There is no such output.");
    return checked(new_data(output));
}

std::optional<std::pair<double, double>> EarlyMonitor::at_start() const {
    if (!at_start_) return std::nullopt;
    const Bounds value = unsigned_zeros(zone_ ? zone_->at_start() : at_start_->value());
    return std::pair{value.lower, value.upper};
}

std::optional<std::pair<double, double>> EarlyMonitor::bounds(std::size_t output,
                                                              Tick sample) const {
    if (output >= outputs_.size()) throw std::out_of_range("There is no such output.");
    if (sample < held(output)) return std::nullopt;
    const Bounds value =
        unsigned_zeros(zone_ ? zone_->at(output, sample) : engine_.at(outputs_[output], sample));
    return std::pair{value.lower, value.upper};
}

Tick EarlyMonitor::held(std::size_t output) const {
    return std::max<Tick>(0, early::plus(final_up_to() + 1, -lag(output)) - 1);
}

std::vector<early::BoundChange> EarlyMonitor::runs(std::size_t output) const {
    if (output >= outputs_.size()) throw std::out_of_range("There is no such output.");
    auto found = zone_ ? zone_->changes(output) : changes_[output].runs(engine_, outputs_[output]);
    for (early::BoundChange& run : found)
        run.bounds = unsigned_zeros(run.bounds);
    return found;
}

std::vector<std::tuple<Tick, Tick, double, double>>
EarlyMonitor::changes(std::size_t output) const {
    std::vector<std::tuple<Tick, Tick, double, double>> result;
    for (const early::BoundChange& run : runs(output))
        result.emplace_back(run.l, run.r, run.bounds.lower, run.bounds.upper);
    return result;
}

nb::object EarlyMonitor::reported(std::size_t output) const {
    const auto runs = this->runs(output);
    const Tick settled = early::plus(final_up_to(), -lag(output));
    auto list = nb::steal(PyList_New(static_cast<Py_ssize_t>(runs.size())));
    if (!list.is_valid()) throw nb::python_error();
    Py_ssize_t place = 0;
    for (const early::BoundChange& run : runs) {
        const bool is_final = finished_ || run.bounds.lower == run.bounds.upper || run.r <= settled;
        PyObject* change =
            settings_.change.value().make(times_.at(run.l), times_.at(run.r), run.bounds, is_final);
        if (change == nullptr) throw nb::python_error();
        fill_list(list.ptr(), place++, change);
    }
    return list;
}

nb::object EarlyMonitor::supposed(
    std::optional<std::size_t> output, Tick sample,
    const std::vector<std::tuple<Tick, Tick, std::vector<double>, std::vector<double>>>& later) {
    guard_.require_idle();
    if (output.value_or(0) >= outputs_.size() && output) {
        throw std::out_of_range("There is no such output.");
    }
    if (output && sample < held(*output)) return nb::none();
    const Tick next = times_.newest() + 1;
    std::vector<early::BoundsEngine::Supposition> suppositions;
    for (const auto& [first, last, lower, upper] : later) {
        if (lower.size() != row_.size() || upper.size() != row_.size() || first < 0) {
            throw std::invalid_argument("There is a bound of every input.");
        }
        early::BoundsEngine::Supposition supposed{next + first, early::plus(next, last), {}};
        for (std::size_t i = 0; i < lower.size(); ++i)
            supposed.row.push_back({lower[i], upper[i]});
        suppositions.push_back(std::move(supposed));
    }
    if (zone_) {
        const early::ZoneEngine zone = zone_->supposed(suppositions);
        const Bounds value = unsigned_zeros(output ? zone.at(*output, sample) : zone.at_start());
        return nb::make_tuple(value.lower, value.upper);
    }
    if (const auto failure = engine_.suppose(suppositions)) {
        const Tick t = failure->tick;
        return checked(fail(*failure, t, next > 0 ? times_.at(t) : static_cast<double>(t)));
    }
    Bounds value{};
    if (output) {
        value = engine_.at(outputs_[*output], sample);
    } else {
        early::BoundsAtStart at_start = at_start_.value();
        at_start.read(engine_);
        value = at_start.value();
    }
    engine_.revert();
    value = unsigned_zeros(value);
    return nb::make_tuple(value.lower, value.upper);
}

std::pair<double, double> EarlyMonitor::causation_at_start() const {
    return caused_of(causes_ ? causes_->at_start() : bounds::anything);
}

std::pair<double, double> EarlyMonitor::causation(std::size_t output, Tick sample) const {
    if (output >= outputs_.size()) throw std::out_of_range("There is no such output.");
    return caused_of(causes_.value().at(output, sample));
}

std::vector<std::tuple<Tick, Tick, double, double>> EarlyMonitor::caused(std::size_t output) const {
    if (output >= outputs_.size()) throw std::out_of_range("There is no such output.");
    std::vector<std::tuple<Tick, Tick, double, double>> result;
    const Tick last = finished_ ? times_.newest() : forever;
    for (const early::BoundChange& run : causes_.value().runs(output, last)) {
        const auto [violation, satisfaction] = caused_of(run.bounds);
        result.emplace_back(run.l, run.r, violation, satisfaction);
    }
    return result;
}

std::optional<Tick> EarlyMonitor::place(double time) const {
    return times_.place(time);
}

std::pair<double, double> EarlyMonitor::known(std::uint32_t input, Tick sample) const {
    if (input >= row_.size()) throw std::out_of_range("There is no such input.");
    const Bounds known = sample < 0 ? ranges_[input] : engine_.known(input, sample);
    return {known.lower, known.upper};
}

double EarlyMonitor::time(Tick sample) const {
    if (times_.newest() < 0) throw std::out_of_range("There is no sample.");
    return times_.at(sample);
}

// ---- state --------------------------------------------------------------------------------------

nb::bytes EarlyMonitor::state() {
    guard_.require_idle();
    settle();
    Snapshot snapshot;
    transfer(snapshot);
    return bytes_of(snapshot);
}

void EarlyMonitor::restore(const nb::bytes& state) {
    guard_.require_idle();
    Snapshot snapshot = snapshot_of(state);
    transfer(snapshot);
    snapshot.end();
}

void EarlyMonitor::transfer(Snapshot& snapshot) {
    if (zone_) {
        zone_->transfer(snapshot);
    } else {
        engine_.transfer(snapshot);
        if (at_start_) at_start_->transfer(snapshot);
    }
    if (causes_) causes_->transfer(snapshot);
    for (auto& decisions : decisions_)
        decisions.transfer(snapshot);
    for (auto& changes : changes_)
        changes.transfer(snapshot);
    times_.transfer(snapshot);
    for (auto& news : news_) {
        early::transfer(snapshot, news);
        for (const Decision& decision : news)
            snapshot.require(0 <= decision.l && decision.l <= decision.r &&
                             decision.r <= times_.newest() && decision.at <= times_.newest());
    }
    snapshot.values(open_.data(), open_.size());
    snapshot.values(kept_.data(), kept_.size());
    snapshot.item(closed_);
    snapshot.item(samples_);
    snapshot.item(finished_);
    snapshot.require(closed_ >= -1 && closed_ < forever);
    for (const Tick open : open_)
        snapshot.require(open >= 0);
    for (std::size_t i = 0; i < outputs_.size(); ++i)
        snapshot.require(kept_[i] >= 0 && kept_[i] <= held(i));
}

std::size_t EarlyMonitor::state_bytes() const {
    std::size_t sum = (zone_ ? zone_->bytes() : engine_.bytes()) + times_.bytes();
    for (const auto& decisions : decisions_)
        sum += decisions.bytes();
    return sum;
}

} // namespace rtamt::python
