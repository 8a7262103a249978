// Propagation of changes to sums: both registers at once, since inf - inf is undefined
// for numbers and not for bounds.
//
// As far as samples have been seen or are supposed one by one, bounds are sums of bounds. Where a
// whole window lies beyond and has the same bounds at every tick, the place of the window is open;
// a sum since the start is bounded there by what was seen, or not at all.
#include "bounds_engine.hpp"

#include <algorithm>

namespace rtamt::early {

void BoundsEngine::lift(State& state, Tick l, Tick r, const Bounds& now) {
    lift(state, 0, l, r, now.lower);
    lift(state, 1, l, r, -now.upper);
}

std::optional<BoundsEngine::Failure> BoundsEngine::add_up(std::uint32_t index, bool first) {
    const Node& own = node(index);
    const State& state = nodes_[index];
    if (state.from >= forever) return std::nullopt; // nothing reads it
    spans_.clear();
    if (first) {
        spans_.emplace_back(0, forever);
    } else {
        for (int reg = 0; reg < 2; ++reg) {
            for (const Piece& piece : new_data(own.a, reg)) {
                sums_[index].change(piece.l, piece.r);
                spans_.emplace_back(plus(piece.l, -own.high), plus(piece.r, -own.low));
            }
        }
        if (summed_ > seen_before_) {
            spans_.emplace_back(seen_before_ + 1 - own.high, summed_ - own.high);
        }
        std::ranges::sort(spans_);
    }
    Tick t = state.from;
    for (const auto& [l, r] : spans_) {
        t = std::max(t, l);
        if (own.low <= -forever) return add_all(index, t);
        const auto failure = add_windows(index, t, r);
        if (failure) return failure;
        t = std::max(t, plus(r, 1));
    }
    return std::nullopt;
}

// The sums at [t, r].
std::optional<BoundsEngine::Failure> BoundsEngine::add_windows(std::uint32_t index, Tick t,
                                                               Tick r) {
    const Node& own = node(index);
    State& state = nodes_[index];
    const Runs& lower = runs(own.a, 0);
    const Runs& upper = runs(own.a, 1);
    while (t <= r && t < forever) {
        const Tick end = t + own.high;
        if (end < 0) { // nothing is in the window yet
            const Tick last = std::min(r, -own.high - 1);
            lift(state, t, last, WindowSums::Add::identity);
            t = last + 1;
            continue;
        }
        const Tick begin = std::max<Tick>(0, t + own.low);
        Tick same = forever; // until when something stays in the window
        if (const auto open = lower.last<AtMost>(begin, end, -infinity)) {
            const Run above = upper.at(open->end);
            if (above.value == -infinity) { // of the sum nothing is known either
                same = std::min(lower.at(open->end).end, above.end);
                t = plus(plus(same, -own.low), 1);
                continue;
            }
        }
        const Run low = lower.at(begin);
        const Run high = upper.at(begin);
        same = std::min(low.end, high.end);
        if (t + own.low >= 0 && end > summed_ && same >= end) {
            const Tick last = std::min(r, plus(same, -own.high));
            lift(state, t, last, sums_[index].anywhere({low.value, -high.value}));
            t = plus(last, 1);
            continue;
        }
        const Bounds sum = sums_[index].at(end, [&](Tick i) { return at(own.a, i); });
        if (!Interval::undefined(sum)) {
            lift(state, t, t, sum);
        } else {
            has_no_value(index, 0, t, true);
            if (const auto failure = fails(index)) return failure;
        }
        ++t;
    }
    return std::nullopt;
}

// The sums since the start, from t on.
std::optional<BoundsEngine::Failure> BoundsEngine::add_all(std::uint32_t index, Tick t) {
    const Node& own = node(index);
    State& state = nodes_[index];
    if (t + own.high < 0) {
        lift(state, t, -own.high - 1, WindowSums::Add::identity);
        t = -own.high;
    }
    t = std::min(t, summed_ + 1 - own.high); // what is unseen takes what was seen further
    Bounds sum = t + own.high > 0 ? at(2 * index, t - 1) : WindowSums::Add::identity;
    for (; t + own.high <= summed_; ++t) {
        sum = WindowSums::Add::join(at(own.a, t + own.high), sum);
        if (Interval::undefined(sum)) {
            has_no_value(index, 0, t, true);
            if (const auto failure = fails(index)) return failure;
            sum = bounds::anything;
        }
        lift(state, t, t, sum);
    }
    const Tick unseen = summed_ + 1;
    const bool rises = runs(own.a, 0).least(unseen, forever) >= 0;
    const bool falls = runs(own.a, 1).least(unseen, forever) >= 0;
    lift(state, t, forever, {rises ? sum.lower : -infinity, falls ? sum.upper : infinity});
    return std::nullopt;
}

} // namespace rtamt::early
