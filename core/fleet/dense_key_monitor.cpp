// Monitors of keys in dense time: delayed verdicts, which run a program, and all others, which run
// graphs.
#include "key_monitor.hpp"

#include "../dense/executor.hpp"
#include "../values/ticks.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

namespace rtamt::fleet {

namespace {

using early::Tick;

// The kind of the caller's times in ticks.py.
constexpr std::string_view seconds = "seconds";

class DenseKeyMonitor : public KeyMonitor {
  public:
    explicit DenseKeyMonitor(const MonitorProgram& program)
        : program_(program), rate_(program.denominator), counts_(program.inputs.size()) {}

  protected:
    const MonitorProgram& program_;
    std::int64_t rate_;
    bool begun_ = false; // whether the time scale is known
    std::vector<std::int64_t> counts_;

    [[nodiscard]] Tick tick_of(double time) const {
        check_time(time);
        const auto tick = ticks::tick_of(time, static_cast<double>(rate_));
        if (!tick) too_far(time);
        return *tick;
    }
    [[noreturn]] static void too_far(double time) {
        throw WrongSample("has a sample at " + shown(time) +
                          " s, too far from 0: subtract a start time, or choose a coarser "
                          "resolution.");
    }
    [[nodiscard]] double time_of(Tick tick) const noexcept {
        return ticks::seconds_of(tick, rate_);
    }
    void transfer_counts(Snapshot& snapshot) {
        snapshot.values(counts_.data(), counts_.size());
        for (const std::int64_t count : counts_)
            snapshot.require(count >= 0 && count < early::forever);
    }
    void put_scale(StateWriter& state) const {
        state.put(std::uint8_t{begun_});
        if (begun_) state.put_text(seconds);
    }
    void take_scale(StateReader& state) {
        begun_ = state.flag();
        if (begun_ && state.take_text() != seconds) StateReader::refuse_python();
    }
};

// ---- delayed verdicts ---------------------------------------------------------------------------

class DenseDelayed final : public DenseKeyMonitor {
  public:
    explicit DenseDelayed(const MonitorProgram& program)
        : DenseKeyMonitor(program), executor_(program.program.value()),
          events_(program.inputs.size()), results_(executor_.program().outputs.size()),
          until_(results_.size()) {}

    AtStart take(const KeySample& sample, std::size_t index, std::vector<Row>& rows) override {
        const Tick tick = tick_of(sample.time);
        if (tick > executor_.last_possible()) too_far(sample.time);
        for (std::size_t input = 0; input < events_.size(); ++input) {
            events_[input] = {};
            if (sample.given[input] == 0) continue;
            check_value(program_, input, sample.values[input], sample.time);
            const auto last = executor_.last_time(input);
            if (last && tick <= *last) not_later(sample.time, time_of(*last));
            events_[input] = {&tick, &sample.values[input].lower, 1};
        }
        const bool empty =
            std::ranges::none_of(sample.given, [](auto given) { return given != 0; });
        if (empty && !begun_) return {};
        for (dense::EventList& list : results_)
            list.resize(0);
        if (const auto failure = executor_.push(events_, results_)) {
            has_no_value(program_, failure->instruction, time_of(failure->time));
        }
        begun_ = true;
        for (std::size_t input = 0; input < events_.size(); ++input)
            counts_[input] += static_cast<std::int64_t>(events_[input].count);
        close();
        const dense::Events known = results_.front().view();
        for (std::size_t i = 0; i < known.count; ++i) {
            const double time = time_of(known.times[i]);
            rows.push_back({index, time, time, {known.values[i], known.values[i]}});
        }
        return {};
    }

    std::vector<std::uint8_t> state() override {
        StateWriter state;
        put_scale(state);
        state.put_snapshot([&](Snapshot& snapshot) { transfer(snapshot); });
        return std::move(state.bytes());
    }

    void restore(std::span<const std::uint8_t> bytes) override {
        StateReader state(bytes);
        take_scale(state);
        state.take_snapshot([&](Snapshot& snapshot) { transfer(snapshot); });
    }

    [[nodiscard]] std::size_t bytes() const override { return executor_.state_bytes(); }

  private:
    dense::Executor executor_;
    std::vector<dense::Events> events_;
    std::vector<dense::EventList> results_;
    std::vector<std::optional<std::int64_t>> until_; // up to when each output was reported

    // Puts a point at the last instant that is known of each output, unless it was reported.
    void close() {
        for (std::size_t output = 0; output < results_.size(); ++output) {
            const auto until = executor_.known_until(output);
            if (!until || until_[output] == until) continue;
            until_[output] = until;
            dense::EventList& list = results_[output];
            if (list.count() == 0 || list.times()[list.count() - 1] != *until) {
                list.append(*until, executor_.value(output));
            }
        }
    }

    // As python::DenseMonitor, whose states these are.
    void transfer(Snapshot& snapshot) {
        executor_.transfer(snapshot);
        transfer_counts(snapshot);
        for (auto& until : until_)
            snapshot.item(until);
        for (dense::EventList& list : results_)
            list.transfer(snapshot);
    }
};

// ---- all other modes ----------------------------------------------------------------------------

class DenseEarly final : public DenseKeyMonitor {
  public:
    explicit DenseEarly(const MonitorProgram& program)
        : DenseKeyMonitor(program),
          monitor_(program.groups, program.groups.size(), program.outputs) {}

    AtStart take(const KeySample& sample, std::size_t index, std::vector<Row>& rows) override {
        const Tick tick = tick_of(sample.time);
        given_.clear();
        for (std::uint32_t input = 0; input < counts_.size(); ++input) {
            if (sample.given[input] == 0) continue;
            check_value(program_, input, sample.values[input], sample.time);
            given_.push_back({input, sample.values[input]});
        }
        if (!program_.lateness) check_order(tick, sample.time);
        if (const auto closed = monitor_.closed(); closed && tick <= *closed) {
            if (!program_.lateness) not_later(sample.time, time_of(*closed));
            return at_start(true);
        }
        if (program_.lateness) {
            std::erase_if(given_, [&](const early::DenseMonitor::Given& each) {
                return !narrows(program_, each.input, each.bounds, monitor_.known(each.input, tick),
                                sample.time);
            });
        }
        if (const auto failure = monitor_.take(tick, given_)) fail(*failure);
        begun_ = true;
        for (const early::DenseMonitor::Given& each : given_)
            ++counts_[each.input];
        return report(index, rows);
    }

    AtStart watermark(double time, std::size_t index, std::vector<Row>& rows) override {
        if (program_.mode == MonitorProgram::Mode::eager) {
            return KeyMonitor::watermark(time, index, rows);
        }
        const Tick tick = tick_of(time);
        if (const auto failure = monitor_.watermark(tick)) fail(*failure);
        begun_ = true;
        if (interval()) mark_ = std::max(mark_.value_or(tick), tick);
        return report(index, rows);
    }

    std::vector<std::uint8_t> state() override {
        StateWriter state;
        put_scale(state);
        if (interval()) { // no corrections: no samples, no states, nothing retracted
            state.put_count(0);
            state.put_count(0);
            state.put(std::uint8_t{0});
            state.put(std::uint8_t{mark_.has_value()});
            if (mark_) state.put(*mark_);
        }
        state.put_snapshot([&](Snapshot& snapshot) { transfer(snapshot); });
        return std::move(state.bytes());
    }

    void restore(std::span<const std::uint8_t> bytes) override {
        StateReader state(bytes);
        take_scale(state);
        if (interval()) {
            state.nothing(2 * sizeof(std::uint64_t) + 1);
            mark_.reset();
            if (state.flag()) mark_ = state.take<Tick>();
        }
        state.take_snapshot([&](Snapshot& snapshot) {
            transfer(snapshot);
            snapshot.require(!monitor_.finished());
        });
    }

    [[nodiscard]] std::size_t bytes() const override { return monitor_.bytes(); }

  private:
    early::DenseRequirements monitor_;
    std::vector<early::DenseMonitor::Given> given_;
    std::optional<Tick> mark_; // the last watermark

    [[nodiscard]] bool interval() const noexcept {
        return program_.mode == MonitorProgram::Mode::interval;
    }

    void check_order(Tick tick, double time) const {
        for (const early::DenseMonitor::Given& each : given_) {
            const auto last = monitor_.newest(each.input);
            if (last && tick <= *last) not_later(time, time_of(*last));
        }
    }

    [[noreturn]] void fail(const early::DenseRequirements::Failure& failure) const {
        const auto& [node, step, tick] = failure.operation;
        has_no_value(program_, program_.steps_before[failure.group][node] + step, time_of(tick));
    }

    [[nodiscard]] AtStart at_start(bool late) {
        if (interval()) {
            const Bounds bounds = monitor_.at_start().value_or(bounds::anything);
            return {{bounds.lower, bounds.upper}, late};
        }
        if (program_.mode != MonitorProgram::Mode::causation) return {};
        const Bounds caused = monitor_.caused_at_start();
        return {{caused.upper + 0.0, caused.lower + 0.0}, late};
    }

    [[nodiscard]] AtStart report(std::size_t index, std::vector<Row>& rows) {
        if (program_.mode == MonitorProgram::Mode::eager) {
            for (const early::Decision& each : monitor_.decisions(0)) {
                const double begin = time_of(each.l);
                const double end = time_of(early::plus(each.r, 1));
                if (begin == end) continue; // no time is in it
                const double verdict = each.satisfied ? infinity : -infinity;
                rows.push_back({index, begin, end, {verdict, verdict}, time_of(each.at)});
            }
        }
        if (interval() && monitor_.outputs() != 0) {
            const Tick lag = program_.lag(0);
            const auto complete = monitor_.complete();
            for (const early::BoundChange& run : monitor_.changes(0)) {
                const double begin = time_of(run.l);
                const double end = time_of(early::plus(run.r, 1));
                if (begin == end) continue; // no time is in it
                const bool settled =
                    complete && lag < early::forever && early::plus(run.r, lag) <= *complete;
                rows.push_back({.index = index,
                                .begin = begin,
                                .end = end,
                                .bounds = run.bounds,
                                .is_final = settled || run.bounds.lower == run.bounds.upper});
            }
        }
        return at_start(false);
    }

    // As python::DenseEarlyMonitor, whose states these are.
    void transfer(Snapshot& snapshot) {
        monitor_.transfer(snapshot);
        transfer_counts(snapshot);
    }
};

} // namespace

std::unique_ptr<KeyMonitor> make_dense_delayed(const MonitorProgram& program) {
    return std::make_unique<DenseDelayed>(program);
}

std::unique_ptr<KeyMonitor> make_dense_early(const MonitorProgram& program) {
    return std::make_unique<DenseEarly>(program);
}

} // namespace rtamt::fleet
