// The times that an online monitor accepts, and how regular they were.
//
// Cost: a few comparisons a sample. Memory: that of timestamps.hpp.
#pragma once

#include "timestamps.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace rtamt::discrete {

class Clock {
  public:
    // A gap may differ from the period by `tolerance` periods. A strict clock refuses any other
    // gap, and the same time again; one that is not counts them as violations. The last `history`
    // times are remembered.
    Clock(double period, double tolerance, bool strict, std::size_t history)
        : timestamps_(period, history), period_(period), tolerance_(tolerance),
          slack_(tolerance * period), strict_(strict) {}

    // Whether the next sample may have this time.
    [[nodiscard]] bool accepts(double time) const noexcept {
        if (!std::isfinite(time)) return false;
        const auto last = timestamps_.last();
        if (!last) return true;
        return strict_ ? time > *last && even(time - *last) : time >= *last;
    }

    // A sample arrived at an accepted time.
    void advance(double time) noexcept {
        if (const auto last = timestamps_.last(); last && !even(time - *last)) ++violations_;
        anchor_ = time;
        steps_ = 0.0;
        timestamps_.add(time);
    }

    // Samples arrived one period apart, the first of a trace at time 0. Times are counted from one
    // that was given, so that they do not drift.
    void tick(std::size_t count) noexcept {
        for (std::size_t i = 0; i < count; ++i) {
            const double time = upcoming(0);
            steps_ += 1.0;
            timestamps_.add(time);
        }
    }

    // The time of the sample after a number of further ones, one period apart.
    [[nodiscard]] double upcoming(std::size_t more) const noexcept {
        if (timestamps_.regular()) return timestamps_.regular_at(timestamps_.count() + more);
        return anchor_ + (steps_ + static_cast<double>(more) + 1.0) * period_;
    }

    void reset() noexcept {
        timestamps_.reset();
        violations_ = 0;
    }

    void transfer(Snapshot& snapshot) {
        timestamps_.transfer(snapshot);
        snapshot.item(anchor_);
        snapshot.item(steps_);
        snapshot.item(violations_);
    }

    [[nodiscard]] double period() const noexcept { return period_; }
    [[nodiscard]] double tolerance() const noexcept { return tolerance_; }
    [[nodiscard]] std::uint64_t violations() const noexcept { return violations_; }
    [[nodiscard]] const Timestamps& timestamps() const noexcept { return timestamps_; }

  private:
    Timestamps timestamps_;
    double period_;
    double tolerance_;
    double slack_;
    double anchor_ = 0.0; // the last time that was given
    double steps_ = 0.0;  // samples since then
    std::uint64_t violations_ = 0;
    bool strict_;

    // Whether two samples may be so far apart.
    [[nodiscard]] bool even(double gap) const noexcept {
        return std::fabs(gap - period_) <= slack_;
    }
};

} // namespace rtamt::discrete
