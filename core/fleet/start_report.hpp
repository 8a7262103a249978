// What the first samples changed when a trace began, which is reported with the last of them.
#pragma once

#include "../early/discrete_monitor.hpp"
#include "key_monitor.hpp"

#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

namespace rtamt::fleet {

class StartReport {
  public:
    // A sample that began the trace, and its time: the monitor need not keep these.
    void add(early::Tick sample, double time) { moments_.emplace_back(sample, time); }
    // Runs that it changed.
    void add(const std::vector<early::BoundChange>& runs);
    void forget() noexcept;

    // All that is to be reported, where the last sample changed `now`.
    [[nodiscard]] std::vector<early::BoundChange> with(std::vector<early::BoundChange> now) const;
    // The time of a sample in it.
    [[nodiscard]] double time(const early::DiscreteMonitor& monitor,
                              early::Tick sample) const noexcept;

    // As monitors of Python remember it. `outputs`: of the monitor.
    void put(StateWriter& state) const;
    void take(StateReader& state, std::size_t outputs);
    void require(Snapshot& snapshot, early::Tick newest) const;

  private:
    std::optional<std::vector<early::BoundChange>> runs_;
    std::vector<std::pair<early::Tick, double>> moments_;

    [[nodiscard]] bool empty() const noexcept { return !runs_ || runs_->empty(); }
};

// A number of a state; throws for an infinity and NaN.
[[nodiscard]] inline double finite(StateReader& state) {
    const auto time = state.take<double>();
    if (!std::isfinite(time)) refuse("it has no time where one belongs");
    return time;
}

} // namespace rtamt::fleet
