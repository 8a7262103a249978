// The c-th smallest (or largest) value of the last w ticks, +inf (or -inf) where fewer have one:
// atleast, wasatleast.
//
// Let R(j) be that of the ticks from j - w to j - 1. At an instant between s and s + 1 the window
// covers a part of two ticks at its ends, and what holds for whole ticks there holds in both
// windows: the result from s on is the smaller of R(s) and R(s + 1). So a rise of R at j is one of
// the result at j, and a fall one at j - 1.
//
// As j moves, the newest segment gains weight and the oldest loses it, each a tick at a time. So
// the next j at which R can change is known, and time moves from one such j to the next.
//
// Cost: O(log n) an event and a change of the result, for n segments in the window, whatever w.
// Memory: 80 bytes a segment and component.
#pragma once

#include "../values/weighted.hpp"
#include "parted.hpp"
#include "ring.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace rtamt::dense {

// One component of a value.
template <bool least>
class RankPart {
  public:
    void configure(std::int64_t width, double order) noexcept {
        width_ = width;
        order_ = static_cast<std::int64_t>(order);
        clear();
    }

    void clear() noexcept {
        state_ = {};
        segments_.clear();
        tree_.clear();
    }

    void checkpoint() noexcept {
        saved_ = state_;
        segments_.checkpoint();
    }

    void rollback() {
        state_ = saved_;
        segments_.rollback();
        rebuild();
    }

    void transfer(Snapshot& snapshot, std::int64_t frontier) {
        snapshot.item(state_);
        segments_.transfer(snapshot);
        snapshot.require(segments_.increasing(-never - 1, frontier, &Segment::begin));
        snapshot.require(segments_.empty() ||
                         (state_.now == later(frontier, 1) && !std::isnan(state_.held.value)));
        snapshot.require(!state_.holds || state_.held.time > frontier);
        if (snapshot.loading()) rebuild();
    }

    // From this time on the operand has this value.
    void take(std::int64_t time, double value, std::vector<Change>& out) {
        const std::int64_t key = Keys::of(value);
        if (segments_.empty()) {
            state_.now = time;
        } else {
            if (segments_.back().key == key) return;
            advance(time, out);
        }
        segments_.push_back({time, key});
        tree_.insert(newest(), 0);
    }

    // All changes of the result up to the frontier.
    void finish(std::int64_t frontier, std::vector<Change>& out) {
        if (!segments_.empty()) advance(later(frontier, 1), out);
        if (state_.holds && state_.held.time <= frontier) {
            out.push_back(state_.held);
            state_.holds = false;
        }
    }

    [[nodiscard]] std::size_t size() const noexcept { return segments_.size(); }
    [[nodiscard]] std::size_t bytes() const noexcept { return segments_.bytes() + tree_.bytes(); }

    static constexpr double outside = least ? infinity : -infinity;

  private:
    using Keys = Key<least>;
    using Name = Weighted::Name;

    struct Segment {
        std::int64_t begin;
        std::int64_t key;
    };
    struct State {
        std::int64_t now = 0;    // j
        std::uint64_t first = 0; // the number of the oldest segment
        double last = outside;   // R(now)
        Change held{0, 0.0};     // a change that the next one may replace
        bool holds = false;
    };

    std::int64_t width_ = 1;
    std::int64_t order_ = 1;
    State state_;
    State saved_;
    Ring<Segment> segments_;
    Weighted tree_;

    [[nodiscard]] Name name(std::size_t i) const noexcept {
        return {segments_[i].key, state_.first + i};
    }
    [[nodiscard]] Name newest() const noexcept { return name(segments_.size() - 1); }
    [[nodiscard]] std::int64_t end(std::size_t i) const noexcept {
        return i + 1 < segments_.size() ? segments_[i + 1].begin : never;
    }

    void rebuild() {
        tree_.clear();
        for (std::size_t i = 0; i < segments_.size(); ++i) {
            const std::int64_t begin = std::max(segments_[i].begin, state_.now - width_);
            tree_.insert(name(i), std::max<std::int64_t>(std::min(end(i), state_.now) - begin, 0));
        }
    }

    void advance(std::int64_t target, std::vector<Change>& out) {
        while (state_.now < target) {
            const std::int64_t tail = state_.now - width_; // the tick that leaves next
            const bool leaves = tail >= segments_.front().begin;
            const std::int64_t limit = leaves ? end(0) : segments_.front().begin;
            std::int64_t step = target - state_.now;
            if (limit != never) step = std::min(step, limit - tail);
            const bool same = leaves && segments_.size() == 1;
            if (!same) {
                step = std::min(step, next_change(leaves));
                tree_.add(newest(), step);
                if (leaves) tree_.add(name(0), -step);
            }
            state_.now += step;
            if (leaves && tail + step == limit) {
                tree_.erase(name(0));
                segments_.pop_front();
                ++state_.first;
            }
            if (!same) compare(out);
        }
    }

    // After how many steps R can change.
    [[nodiscard]] std::int64_t next_change(bool leaves) const noexcept {
        const auto place = tree_.find(order_);
        if (!place) return leaves ? never : order_ - tree_.total();
        const Name gains = newest();
        const Name loses = name(0);
        const auto rate = [&](bool inclusive) {
            const auto counts = [&](const Name& name) {
                return static_cast<int>(inclusive ? name <= place->name : name < place->name);
            };
            return counts(gains) - (leaves ? counts(loses) : 0);
        };
        std::int64_t steps = never;
        if (rate(false) > 0) steps = order_ - place->before;
        if (rate(true) < 0) steps = std::min(steps, place->upto - order_ + 1);
        return steps;
    }

    void compare(std::vector<Change>& out) {
        const auto place = tree_.find(order_);
        const double value = place ? Keys::value(place->name.key) : outside;
        if (value == state_.last) return;
        const std::int64_t time = state_.now - static_cast<std::int64_t>(value < state_.last);
        if (state_.holds && state_.held.time != time) out.push_back(state_.held);
        state_.held = {time, value};
        state_.holds = true;
        state_.last = value;
    }
};

template <ValueDomain D, bool least>
using Rank = Parted<D, RankPart<least>>;

} // namespace rtamt::dense
