// Monitors of keys in discrete time: verdicts, bounds and causation before the horizon.
#include "key_monitor.hpp"
#include "start_report.hpp"

#include "../early/discrete_monitor.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rtamt::fleet {

namespace {

using early::Tick;

// How many times the clock of Python keeps at first.
constexpr std::int64_t few_times = 64;

[[nodiscard]] early::DiscreteSettings settings_of(const MonitorProgram& program) {
    const early::DenseSettings& of = program.groups.front().settings;
    early::DiscreteSettings settings;
    settings.outputs = of.outputs;
    settings.at_start = of.at_start;
    settings.ranges = of.ranges;
    settings.period = program.period();
    settings.tolerance = program.tolerance;
    settings.lateness = program.lateness;
    settings.decides = of.decides;
    settings.causes = of.causes;
    return settings;
}

class DiscreteEarly final : public KeyMonitor {
  public:
    explicit DiscreteEarly(const MonitorProgram& program)
        : program_(program), monitor_(program.groups.front().graph, settings_of(program)) {}

    AtStart take(const KeySample& sample, std::size_t index, std::vector<Row>& rows) override {
        check_time(sample.time);
        for (std::size_t input = 0; input < program_.inputs.size(); ++input) {
            if (sample.given[input] != 0) {
                check_value(program_, input, sample.values[input], sample.time);
            }
        }
        if (!monitor_.late()) {
            take_next(sample);
        } else if (monitor_.newest() >= 0) {
            began_.forget();
            if (!learn(monitor_, seen_of(sample))) return at_start(true);
        } else {
            if (comes_too_late(sample.time)) return at_start(true);
            keep(seen_of(sample));
            const double span = early_.back().time - early_.front().time;
            if (std::nearbyint(span / monitor_.period()) >=
                    static_cast<double>(*program_.lateness) ||
                is_first(early_.front().time, mark_)) {
                begin();
            }
        }
        return report(index, rows);
    }

    AtStart watermark(double time, std::size_t index, std::vector<Row>& rows) override {
        if (!interval()) return KeyMonitor::watermark(time, index, rows);
        check_time(time);
        began_.forget();
        if (!early_.empty() && is_first(early_.front().time, time)) begin();
        if (const auto failure = monitor_.watermark(time)) {
            fail(*failure, monitor_.newest(), monitor_.last_time());
        }
        mark_ = std::max(mark_.value_or(time), time);
        return report(index, rows);
    }

    std::vector<std::uint8_t> state() override {
        StateWriter state;
        // The clock: no times but seconds.
        state.put(std::uint8_t{0});
        state.put_count(0);
        state.put_count(0);
        state.put(few_times);
        if (interval()) {
            put_early(state);
            // No corrections: no samples, no states, nothing retracted.
            state.put_count(0);
            state.put_count(0);
            state.put(std::uint8_t{0});
            state.put(std::uint8_t{mark_.has_value()});
            if (mark_) state.put(*mark_);
            state.put(std::int64_t{0}); // nothing was filled in
            began_.put(state);
        }
        monitor_.settle();
        state.put_snapshot([&](Snapshot& snapshot) { monitor_.transfer(snapshot); });
        return std::move(state.bytes());
    }

    void restore(std::span<const std::uint8_t> bytes) override {
        StateReader state(bytes);
        state.nothing(1 + 2 * sizeof(std::uint64_t));
        (void)state.take<std::int64_t>();
        if (interval()) {
            take_early(state);
            state.nothing(2 * sizeof(std::uint64_t) + 1);
            mark_.reset();
            if (state.flag()) mark_ = finite(state);
            state.nothing(sizeof(std::uint64_t));
            began_.take(state, monitor_.outputs());
        }
        state.take_snapshot([&](Snapshot& snapshot) {
            monitor_.transfer(snapshot);
            snapshot.require(!monitor_.finished());
            began_.require(snapshot, monitor_.newest());
        });
    }

    [[nodiscard]] std::size_t bytes() const override { return monitor_.bytes(); }

  private:
    // What came at a time, where samples may be late.
    struct Seen {
        double time = 0;
        std::vector<early::DenseMonitor::Given> known;
        Tick tick = 0; // before the trace starts, from its earliest sample on
    };

    const MonitorProgram& program_;
    early::DiscreteMonitor monitor_;
    std::vector<Bounds> row_;
    std::vector<double> exact_;
    std::vector<early::DiscreteMonitor::Observation> observations_;
    std::optional<double> mark_; // the last watermark
    std::vector<Seen> early_;    // that came before it is known where the trace starts, in order
    std::optional<early::DiscreteMonitor> rehearsal_; // which has taken them
    bool begins_anywhere_ = false;                    // whether it takes earlier ones
    StartReport began_;                               // what these changed, until the next sample

    [[nodiscard]] bool interval() const noexcept {
        return program_.mode == MonitorProgram::Mode::interval;
    }

    [[nodiscard]] Bounds missing(std::size_t input, double time) const {
        const MonitorProgram::Input& of = program_.inputs[input];
        if (program_.mode == MonitorProgram::Mode::causation) {
            throw WrongSample("has no value of '" + of.name + "' at " + shown(time) +
                              " s, and causation needs exact samples: give a number.");
        }
        return of.range;
    }

    [[noreturn]] void fail(const early::DiscreteMonitor::Failure& failure, Tick place,
                           double time) const {
        const double steps = static_cast<double>(failure.tick) - static_cast<double>(place);
        has_no_value(program_, program_.steps_before.front()[failure.node] + failure.step,
                     time + steps * monitor_.period());
    }

    // ---- samples in order

    void take_next(const KeySample& sample) {
        row_.clear();
        exact_.clear();
        for (std::size_t input = 0; input < program_.inputs.size(); ++input) {
            row_.push_back(sample.given[input] != 0 ? sample.values[input]
                                                    : missing(input, sample.time));
            if (row_.back().lower == row_.back().upper) exact_.push_back(row_.back().lower);
        }
        const Tick place = next_place(sample.time);
        const auto failure = exact_.size() == row_.size()
                                 ? monitor_.row(place, sample.time, std::span<const double>(exact_))
                                 : monitor_.row(place, sample.time, std::span<const Bounds>(row_));
        if (failure) fail(*failure, place, sample.time);
    }

    [[nodiscard]] Tick next_place(double time) const {
        const auto place = monitor_.place(time);
        if (monitor_.newest() < 0) return place.value_or(0);
        const double last = monitor_.last_time();
        if (time <= last) not_later(time, last);
        if (!place || !monitor_.in_order(*place)) off_grid(time, last);
        return *place;
    }

    [[noreturn]] void off_grid(double time, double last) const {
        throw WrongSample("has a sample at " + shown(time) + " s, which is not one period of " +
                          shown(monitor_.period()) + " s after the one at " + shown(last) + " s.");
    }

    // ---- samples in any order

    [[nodiscard]] Seen seen_of(const KeySample& sample) const {
        Seen seen{sample.time, {}};
        for (std::uint32_t input = 0; input < program_.inputs.size(); ++input) {
            if (sample.given[input] != 0) seen.known.push_back({input, sample.values[input]});
        }
        return seen;
    }

    // Whether a watermark excludes all samples before one.
    [[nodiscard]] bool is_first(double time, std::optional<double> mark) const noexcept {
        return mark && (*mark - time) / monitor_.period() + program_.tolerance >= -1;
    }

    // Whether a sample that came before the trace starts is too late for the newest one of them, or
    // for the watermark.
    [[nodiscard]] bool comes_too_late(double time) const {
        const double period = monitor_.period();
        const double last = early_.empty() ? time : early_.back().time;
        double closed = early_.empty() ? -infinity : -static_cast<double>(*program_.lateness) - 1;
        if (mark_) {
            closed = std::max(closed, std::floor((*mark_ - last) / period + program_.tolerance));
        }
        const double steps = std::nearbyint((time - last) / period);
        if (steps > closed) return false;
        if (std::fabs(time - last - steps * period) > program_.tolerance * period) {
            off_grid(time, last);
        }
        return true;
    }

    // Whether a sample did not come too late, and was taken.
    [[nodiscard]] bool learn(early::DiscreteMonitor& monitor, const Seen& seen) {
        const auto place = monitor.place(seen.time);
        if (!place) off_grid(seen.time, monitor.last_time());
        if (monitor.newest() >= 0 && *place <= monitor.closed()) return false;
        observations_.clear();
        for (const auto& [input, bounds] : seen.known) {
            if (narrows(program_, input, bounds, monitor.known(input, *place), seen.time)) {
                observations_.push_back({input, *place, *place, bounds});
            }
        }
        if (const auto failure = monitor.learn(*place, seen.time, observations_)) {
            fail(*failure, *place, seen.time);
        }
        return true;
    }

    // The sample of a time that follows another, if it is on its grid.
    [[nodiscard]] std::optional<Tick> following(const Seen& seen, double time) const noexcept {
        const double period = monitor_.period();
        const double steps = std::nearbyint((time - seen.time) / period);
        if (std::fabs(time - seen.time - steps * period) > program_.tolerance * period) return {};
        return seen.tick + static_cast<Tick>(steps);
    }

    // That of a time before all others.
    [[nodiscard]] std::optional<Tick> preceding(const Seen& seen, double time) const noexcept {
        const auto place = rehearsal_->place(time);
        return begins_anywhere_ && place && *place > rehearsal_->closed() && *place < seen.tick
                   ? place
                   : std::nullopt;
    }

    // Whether a sample would be the same one if it had come in order.
    [[nodiscard]] bool fits(std::vector<Seen>::const_iterator after, double time, Tick tick) const {
        return rehearsal_->place(time) == tick &&
               (after == early_.end() || following({time, {}, tick}, after->time) == after->tick);
    }

    // Keeps a sample until it is known where the trace starts, in the order of their times; throws
    // for one that cannot be taken then.
    void keep(Seen&& seen) {
        const auto after = std::ranges::upper_bound(early_, seen.time, {}, &Seen::time);
        if (rehearsal_) {
            const auto tick = after == early_.begin() ? preceding(*after, seen.time)
                                                      : following(*std::prev(after), seen.time);
            if (tick && fits(after, seen.time, *tick)) {
                (void)learn(*rehearsal_, seen);
                seen.tick = *tick;
                early_.insert(after, std::move(seen));
                return;
            }
        }
        early_.insert(after, std::move(seen));
        rehearsal_.emplace(program_.groups.front().graph, settings_of(program_));
        begins_anywhere_ = rehearsal_->begin_at(*program_.lateness);
        for (Seen& each : early_) {
            (void)learn(*rehearsal_, each);
            each.tick = rehearsal_->newest();
        }
    }

    // Takes the samples that were kept, in order, so that none is too late; all that they change
    // counts as changed by the last of them.
    void begin() {
        for (const Seen& seen : early_) {
            const Tick before = monitor_.newest();
            (void)learn(monitor_, seen);
            if (monitor_.newest() > before) began_.add(monitor_.newest(), seen.time);
            if (monitor_.outputs() != 0) began_.add(monitor_.changes(0));
        }
        early_.clear();
        rehearsal_.reset();
    }

    // ---- what monitors of Python remember of that

    void put_early(StateWriter& state) const {
        state.put_count(early_.size());
        for (const Seen& seen : early_) {
            state.put(seen.time);
            state.put_count(seen.known.size());
            for (const auto& [input, bounds] : seen.known) {
                state.put_text(program_.inputs[input].name);
                state.put(std::uint8_t{1});
                state.put(bounds.lower);
                state.put(bounds.upper);
            }
        }
    }

    void take_early(StateReader& state) {
        early_.clear();
        const std::size_t count = state.take_count();
        for (std::size_t i = 0; i < count; ++i) {
            Seen seen{finite(state), {}, 0};
            const std::size_t known = state.take_count();
            for (std::size_t k = 0; k < known; ++k) {
                const std::uint32_t input = input_called(state.take_text());
                if (!state.flag()) continue; // it is missing
                const auto lower = state.take<double>();
                const auto upper = state.take<double>();
                if (!(lower <= upper)) refuse("it has bounds that are reversed");
                seen.known.push_back({input, {lower, upper}});
            }
            early_.insert(std::ranges::upper_bound(early_, seen.time, {}, &Seen::time),
                          std::move(seen));
        }
    }

    [[nodiscard]] std::uint32_t input_called(std::string_view name) const {
        const auto found = std::ranges::find(program_.inputs, name, &MonitorProgram::Input::name);
        if (found == program_.inputs.end()) refuse("it has an unknown name");
        return static_cast<std::uint32_t>(found - program_.inputs.begin());
    }

    // ---- results

    [[nodiscard]] AtStart at_start(bool late = false) const {
        if (interval()) {
            const Bounds bounds = monitor_.at_start().value_or(bounds::anything);
            return {{bounds.lower, bounds.upper}, late};
        }
        if (program_.mode != MonitorProgram::Mode::causation) return {};
        const Bounds caused = monitor_.caused_at_start();
        return {{caused.upper + 0.0, caused.lower + 0.0}};
    }

    [[nodiscard]] AtStart report(std::size_t index, std::vector<Row>& rows) const {
        if (program_.mode == MonitorProgram::Mode::eager) {
            for (const early::Decision& each : monitor_.decisions(0)) {
                const double verdict = each.satisfied ? infinity : -infinity;
                const double decided = monitor_.time(each.at);
                for (Tick t = each.l; t <= each.r; ++t) {
                    const double time = monitor_.time(t);
                    rows.push_back({index, time, time, {verdict, verdict}, decided});
                }
            }
        }
        if (interval() && monitor_.outputs() != 0) {
            for (const early::BoundChange& run : began_.with(monitor_.changes(0))) {
                rows.push_back({.index = index,
                                .begin = began_.time(monitor_, run.l),
                                .end = began_.time(monitor_, run.r),
                                .bounds = run.bounds,
                                .is_final = monitor_.is_final(0, run)});
            }
        }
        return at_start();
    }
};

} // namespace

std::unique_ptr<KeyMonitor> make_discrete_early(const MonitorProgram& program) {
    return std::make_unique<DiscreteEarly>(program);
}

} // namespace rtamt::fleet
