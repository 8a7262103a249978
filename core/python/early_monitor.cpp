#include "early_monitor.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>
#include <ranges>
#include <stdexcept>

namespace rtamt::python {

using early::forever;
using early::Tick;

namespace {

// How many samples come between two looks at what is not needed any more.
constexpr std::int64_t pause = 64;

[[nodiscard]] std::optional<early::BoundsAtStart>
at_start_of(std::vector<early::Item> items, const early::BoundsEngine& engine, bool follows) {
    if (items.empty()) return std::nullopt;
    return early::BoundsAtStart(std::move(items), engine, follows);
}

} // namespace

EarlyMonitor::EarlyMonitor(const early::Graph& graph, std::vector<std::uint32_t> outputs,
                           const std::vector<early::Item>& items, std::vector<Bounds> ranges,
                           const std::vector<nb::str>& names, const nb::object& ignored,
                           const nb::dict& types, EarlySettings settings,
                           const std::optional<EarlyCauses>& causes, Exceptions exceptions)
    : engine_(graph, ranges, settings.late), outputs_(std::move(outputs)),
      decisions_(outputs_.size()), at_start_(at_start_of(items, engine_, causes.has_value())),
      times_(settings.period, settings.tolerance), ranges_(std::move(ranges)),
      settings_(std::move(settings)), exceptions_(std::move(exceptions)),
      guard_(exceptions_.refused, exceptions_.in_use), names_(names, graph.inputs, ignored, types),
      row_(graph.inputs), given_(graph.inputs), news_(outputs_.size()), changes_(outputs_.size()),
      open_(outputs_.size(), 0), kept_(outputs_.size(), 0), wanted_(engine_.size()) {
    ranges_.resize(graph.inputs, bounds::anything);
    std::uint32_t before = 0;
    steps_before_ = steps_before(graph, before);
    for (const std::uint32_t output : outputs_) {
        if (output / 2 >= engine_.size()) throw std::invalid_argument("There is no such output.");
    }
    if (causes) {
        causes_.emplace(causes_of(*causes), engine_, at_start_.value(), false);
        causation_.emplace(causation_of(*causes));
    }
    if (!causes) { // which are of every value, needed or not
        std::vector<Tick> last(engine_.size(), -1);
        for (const std::uint32_t output : outputs_)
            last[output / 2] = forever;
        if (at_start_) at_start_->limit(last);
        engine_.limit(last);
        // What is late may need any tick, and verdicts cost little as they are.
        if (!settings_.late && !settings_.verdict && !outputs_.empty()) {
            zone_ = early::ZoneEngine::of(graph, outputs_, items, ranges_, settings_.zone);
        }
    }
    // What is known before any sample came, such as the truth of constants, waits for the first.
    for (std::size_t i = 0; i < outputs_.size(); ++i)
        decisions_[i].begin(engine_, outputs_[i]);
}

// ---- samples ------------------------------------------------------------------------------------

bool EarlyMonitor::in_order(Tick index) const noexcept {
    const Tick newest = times_.newest();
    return newest < 0 || index == newest + 1 || (index > newest && index - 1 <= closed_);
}

PyObject* EarlyMonitor::update(PyObject* time, const Named& values) noexcept {
    if (!guard_.open(finished_)) return nullptr;
    if (settings_.replays) return guard_.refuse("replays");
    double t = 0.0;
    if (!numbers_.read(time, t) || std::fabs(t) >= implausible) return guard_.refuse("time");
    const auto index = times_.place(t);
    if (!index) return guard_.refuse("time");
    if (settings_.late && times_.newest() < 0) return guard_.refuse("first");
    if (!settings_.late && (!in_order(*index) || values.count() != names_.count())) {
        return guard_.refuse("order");
    }
    std::size_t guess = 0;
    observations_.clear();
    const char* wrong = values.each([&](PyObject* name, PyObject* value) -> const char* {
        const auto input = names_.place(name, guess++, true);
        if (!input) return "names";
        if (!names_.read(numbers_, *input, value, row_[*input])) return "value";
        const double x = row_[*input];
        if (settings_.late) {
            const Bounds known = *index < 0
                                     ? ranges_[*input]
                                     : engine_.known(static_cast<std::uint32_t>(*input), *index);
            if (known.lower > x || x > known.upper) return "contradiction";
            observations_.push_back({static_cast<std::uint32_t>(*input), *index, *index, {x, x}});
        } else if (ranges_[*input].lower > x || x > ranges_[*input].upper) {
            return "range";
        }
        return nullptr;
    });
    if (wrong != nullptr) return guard_.refuse(wrong);
    if (settings_.late && *index <= closed_) return guard_.refuse("late");
    try {
        const auto failure = settings_.late ? observe(*index) : row(*index, row_);
        if (failure) return fail(*failure, *index, t);
        return advance(*index, t);
    } catch (const std::bad_alloc&) {
        return PyErr_NoMemory();
    }
}

template <class Value>
std::optional<EarlyMonitor::Failure> EarlyMonitor::row(Tick index,
                                                       const std::vector<Value>& values) {
    const std::span<const Value> all(values);
    return zone_ ? zone_->row(index, all) : engine_.row(index, all);
}

// Takes observations, late or not.
std::optional<EarlyMonitor::Failure> EarlyMonitor::observe(Tick index) {
    engine_.settle_inputs(closed_after(index));
    return engine_.learn(observations_, index);
}

Tick EarlyMonitor::closed_after(Tick index) const noexcept {
    const Tick newest = std::max(times_.newest(), index);
    return std::max(closed_, settings_.late ? newest - settings_.lateness - 1 : newest);
}

void EarlyMonitor::require(std::int64_t after) {
    guard_.require_idle();
    guard_.require(after == samples_ && !finished_);
}

nb::object EarlyMonitor::checked(PyObject* result) {
    if (result == nullptr) throw nb::python_error();
    return nb::steal(result);
}

nb::object EarlyMonitor::take(double time, const std::vector<double>& lower,
                              const std::vector<double>& upper, std::int64_t after) {
    require(after);
    const auto index = times_.place(time);
    if (!index || !in_order(*index) || lower.size() != row_.size() || upper.size() != row_.size()) {
        return checked(guard_.refuse("order"));
    }
    std::vector<Bounds> row;
    row.reserve(lower.size());
    for (std::size_t i = 0; i < lower.size(); ++i)
        row.push_back({lower[i], upper[i]});
    const auto failure = this->row(*index, row);
    return checked(failure ? fail(*failure, *index, time) : advance(*index, time));
}

nb::object EarlyMonitor::learn(double time,
                               const std::vector<std::tuple<std::uint32_t, double, double>>& values,
                               std::int64_t after) {
    require(after);
    const auto index = times_.place(time);
    if (!index || !settings_.late || *index <= closed_) return checked(guard_.refuse("late"));
    observations_.clear();
    for (const auto& [input, lower, upper] : values) {
        if (input >= row_.size()) throw std::out_of_range("There is no such input.");
        observations_.push_back({input, *index, *index, {lower, upper}});
    }
    const auto failure = observe(*index);
    return checked(failure ? fail(*failure, *index, time) : advance(*index, time));
}

nb::object EarlyMonitor::watermark(double time) {
    guard_.require_idle();
    if (times_.newest() >= 0) {
        const Tick floor = times_.floor(time);
        if (floor > closed_) {
            if (settings_.late) {
                const auto failure = engine_.close_inputs(floor);
                if (failure) return checked(fail(*failure, times_.newest(), times_.last()));
            }
            closed_ = floor;
            settle();
        }
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
    const auto seconds = nb::steal(PyFloat_FromDouble(time + steps * settings_.period));
    if (raised.is_valid() && seconds.is_valid() &&
        PyObject_SetAttrString(raised.ptr(), "time", seconds.ptr()) == 0) {
        PyErr_SetObject(exceptions_.undefined.ptr(), raised.ptr());
    }
    return nullptr;
}

// The engine has taken a sample.
PyObject* EarlyMonitor::advance(Tick index, double time) {
    const Tick before = times_.newest();
    if (index > before) times_.add(index, time);
    ++samples_;
    closed_ = closed_after(index);
    note(before);
    if (samples_ % pause == 0) settle();
    return result();
}

// Reads what the last change of the engine has changed up to the newest sample.
void EarlyMonitor::note(Tick before) {
    if (zone_) return; // it is asked for changes
    const Tick newest = times_.newest();
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
        if (settings_.verdict) {
            news_[i].clear();
            decisions_[i].collect(engine_, outputs_[i], newest, newest, news_[i]);
            continue;
        }
        changes_[i].collect(engine_, outputs_[i], before, newest);
    }
    if (at_start_) at_start_->read(engine_);
    if (causes_) causes_->read(engine_, *at_start_, newest);
}

Tick EarlyMonitor::lag(std::size_t output) const {
    return std::max<Tick>(0, engine_.horizon(outputs_.at(output)));
}

// What is missing behind the newest sample cuts windows if the trace ends now.
Tick EarlyMonitor::final_up_to() const noexcept {
    return std::min(closed_, times_.newest());
}

void EarlyMonitor::settle() {
    std::ranges::fill(wanted_, forever);
    const Tick closed = final_up_to();
    Tick oldest = closed;
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
        Tick& wanted = wanted_[outputs_[i] / 2];
        Tick from = 0;
        if (settings_.verdict) {
            open_[i] = early::EagerVerdicts::open(engine_, outputs_[i], open_[i]);
            from = std::max(early::plus(closed + 1, -lag(i)), open_[i]);
            oldest = std::min({oldest, decisions_[i].oldest(), early::oldest_of(news_[i])});
        } else {
            from = std::min(held(i), zone_ ? zone_->first_change(i) : changes_[i].first());
            from = kept_[i] = std::max(kept_[i], from);
            if (zone_) zone_->drop_before(i, from);
        }
        wanted = std::min(wanted, from);
        oldest = std::min(oldest, wanted);
    }
    times_.drop_before(oldest);
    if (zone_) return;
    if (at_start_) at_start_->settle(engine_, closed, wanted_);
    if (causes_) causes_->settle(engine_, closed, wanted_);
    engine_.settle(closed, wanted_);
}

nb::object EarlyMonitor::finish() {
    guard_.require_idle();
    const Tick end = times_.newest() + 1;
    std::optional<Failure> failure;
    const auto zone = zone_ ? std::optional(zone_->ended()) : std::nullopt;
    std::vector<early::BoundsEngine::Rest> rests;
    if (!zone) rests = engine_.ended(outputs_, end, &failure);
    if (failure) return checked(fail(*failure, end - 1, times_.last()));
    if (settings_.verdict) {
        for (std::size_t i = 0; i < outputs_.size(); ++i) {
            news_[i].clear();
            const auto& rest = rests[i];
            for (Tick t = std::max(rest.first, open_[i]); t < end; ++t) {
                const Bounds was = engine_.at(outputs_[i], t);
                const Bounds now = rest.bounds[static_cast<std::size_t>(t - rest.first)];
                if (was.lower > 0 || was.upper < 0) continue;
                if (now.lower > 0) news_[i].push_back({t, t, end - 1, true});
                if (now.upper < 0) news_[i].push_back({t, t, end - 1, false});
            }
        }
        finished_ = true;
        return checked(result());
    }
    nb::list all;
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
        const Tick first = std::min(kept_[i], end);
        nb::list values;
        const auto add = [&](const Bounds& each) {
            const Bounds bounds = unsigned_zeros(each);
            values.append(nb::make_tuple(bounds.lower, bounds.upper));
        };
        if (zone) {
            std::ranges::for_each(zone->all_from(i, first), add);
        } else {
            std::ranges::for_each(rests[i].bounds | std::views::drop(first - rests[i].first), add);
        }
        all.append(nb::make_tuple(first, values));
    }
    nb::object start = nb::none();
    if (at_start_ && end > 0) {
        const Bounds value =
            unsigned_zeros(zone ? zone->at_start() : at_start_->ended(engine_, end));
        start = nb::make_tuple(value.lower, value.upper);
    }
    finished_ = true;
    return nb::make_tuple(all, start);
}

} // namespace rtamt::python
