// count: the number of ticks of the last w with a positive operand, a pulse of one tick each.
//
// The window [s - w, s] meets the ticks from s - w to s. A run of several positive ticks, as the
// upper bound of a pulse that is not known may have, counts as infinitely many where more than one
// of them is met: their number would be a line, not a step function.
//
// Cost: amortised O(1) an event, whatever w. Memory: 16 bytes a run in the window and component.
#pragma once

#include "parted.hpp"
#include "ring.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace rtamt::dense {

// One component of a value.
class PulsePart {
  public:
    // A window of the width `never` has no end.
    void configure(std::int64_t width) noexcept {
        width_ = width;
        clear();
    }

    void clear() noexcept {
        state_ = {};
        leaving_.clear();
    }

    void checkpoint() noexcept {
        saved_ = state_;
        leaving_.checkpoint();
    }

    void rollback() noexcept {
        state_ = saved_;
        leaving_.rollback();
    }

    void transfer(Snapshot& snapshot, std::int64_t frontier) {
        snapshot.item(state_.begin);
        snapshot.item(state_.on);
        snapshot.item(state_.wide);
        snapshot.item(state_.single);
        snapshot.item(state_.several);
        leaving_.transfer(snapshot);
        snapshot.require(!state_.on || state_.begin <= frontier);
        snapshot.require(leaving_.increasing(frontier, never - 1, &Leaving::time));
    }

    // From this time on the operand has this value.
    void take(std::int64_t time, double value, std::vector<Change>& out) {
        const bool on = value > 0.0;
        if (on == state_.on) return;
        advance(time - 1, out);
        if (on) {
            state_.begin = time;
            ++state_.single;
        } else {
            if (state_.wide) leave(time - 1, true);
            leave(time, false);
        }
        state_.on = on;
        state_.wide = false;
        put(time, out);
    }

    // All changes of the result up to the frontier.
    void finish(std::int64_t frontier, std::vector<Change>& out) { advance(frontier, out); }

    [[nodiscard]] std::size_t size() const noexcept {
        return leaving_.size() + static_cast<std::size_t>(state_.on && !state_.wide);
    }
    [[nodiscard]] std::size_t bytes() const noexcept { return leaving_.bytes(); }

  private:
    // When the last tick but one of a run has left the window, or the last.
    struct Leaving {
        std::int64_t time;
        std::int64_t wide;
    };
    struct State {
        std::int64_t begin = 0;    // of the run that goes on
        bool on = false;           // whether there is one
        bool wide = false;         // whether the window meets several ticks of it
        std::uint64_t single = 0;  // runs of which the window meets one tick
        std::uint64_t several = 0; // and those of which it meets more
    };

    std::int64_t width_ = 1;
    State state_;
    State saved_;
    Ring<Leaving> leaving_;

    void leave(std::int64_t end, bool wide) {
        const std::int64_t time = later(end, width_);
        if (time != never) leaving_.push_back({time, wide ? 1 : 0});
    }

    void put(std::int64_t time, std::vector<Change>& out) const {
        out.push_back({time, state_.several != 0 ? std::numeric_limits<double>::infinity()
                                                 : static_cast<double>(state_.single)});
    }

    void advance(std::int64_t until, std::vector<Change>& out) {
        for (;;) {
            const bool may_widen = state_.on && !state_.wide && width_ > 0;
            const std::int64_t widens = may_widen ? later(state_.begin, 1) : never;
            const std::int64_t leaves = leaving_.empty() ? never : leaving_.front().time;
            const std::int64_t time = std::min(widens, leaves);
            if (time > until || time == never) return;
            if (widens == time) {
                state_.wide = true;
                --state_.single;
                ++state_.several;
            }
            if (leaves == time) {
                if (leaving_.front().wide != 0) {
                    --state_.several;
                    ++state_.single;
                } else {
                    --state_.single;
                }
                leaving_.pop_front();
            }
            put(time, out);
        }
    }
};

template <ValueDomain N>
using Pulses = Parted<N, PulsePart>;

} // namespace rtamt::dense
