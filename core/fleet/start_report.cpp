#include "start_report.hpp"

#include <algorithm>
#include <cstdint>
#include <iterator>

namespace rtamt::fleet {

using early::Tick;

void StartReport::add(const std::vector<early::BoundChange>& runs) {
    if (!runs_) runs_.emplace();
    runs_->insert(runs_->end(), runs.begin(), runs.end());
}

void StartReport::forget() noexcept {
    runs_.reset();
    moments_.clear();
}

std::vector<early::BoundChange> StartReport::with(std::vector<early::BoundChange> now) const {
    if (empty()) return now;
    std::vector<early::BoundChange> all = *runs_;
    all.insert(all.end(), now.begin(), now.end());
    return early::latest(all);
}

double StartReport::time(const early::DiscreteMonitor& monitor, Tick sample) const noexcept {
    if (empty()) return monitor.time(sample);
    const auto after = std::ranges::upper_bound(
        moments_, sample, {}, [](const std::pair<Tick, double>& moment) { return moment.first; });
    if (after == moments_.begin()) return monitor.time(sample);
    const auto& [earlier, time] = *std::prev(after);
    if (earlier == sample) return time;
    return time + static_cast<double>(sample - earlier) * monitor.period();
}

void StartReport::put(StateWriter& state) const {
    state.put_count(runs_ ? 1 : 0);
    if (runs_) {
        state.put(std::int64_t{0});
        state.put_count(runs_->size());
        for (const early::BoundChange& run : *runs_) {
            state.put(run.l);
            state.put(run.r);
            state.put(run.bounds.lower);
            state.put(run.bounds.upper);
        }
    }
    state.put_count(moments_.size());
    for (const auto& [sample, time] : moments_) {
        state.put(sample);
        state.put(time);
    }
}

void StartReport::take(StateReader& state, std::size_t outputs) {
    forget();
    const std::size_t reported = state.take_count();
    if (reported > 1 || (reported == 1 && (state.take<std::int64_t>() != 0 || outputs != 1))) {
        refuse("it has another output");
    }
    if (reported == 1) {
        runs_.emplace();
        const std::size_t count = state.take_count();
        for (std::size_t i = 0; i < count; ++i) {
            early::BoundChange run{};
            run.l = state.take<Tick>();
            run.r = state.take<Tick>();
            run.bounds.lower = state.take<double>();
            run.bounds.upper = state.take<double>();
            if (!(run.bounds.lower <= run.bounds.upper)) refuse("it has bounds that are reversed");
            runs_->push_back(run);
        }
    }
    const std::size_t count = state.take_count();
    for (std::size_t i = 0; i < count; ++i) {
        const auto sample = state.take<Tick>();
        if (sample < 0 || (i > 0 && sample <= moments_.back().first)) {
            refuse("its times are not in order");
        }
        moments_.emplace_back(sample, finite(state));
    }
}

void StartReport::require(Snapshot& snapshot, Tick newest) const {
    if (!runs_) return;
    for (const early::BoundChange& run : *runs_)
        snapshot.require(0 <= run.l && run.l <= run.r && run.r <= newest);
}

} // namespace rtamt::fleet
