#include "causation_until.hpp"

#include "../values/algebra.hpp"

#include <algorithm>
#include <deque>
#include <ranges>
#include <utility>

namespace rtamt::early {

// ---- a register ---------------------------------------------------------------------------------

// Reverses a range of ticks; false if it is empty.
bool View::turn(Tick& l, Tick& r) const noexcept {
    if (reversed_) l = -std::exchange(r, -l);
    l = std::max<Tick>(0, l); // before the start there is nothing
    return l <= r;
}

Run View::at(Tick t) const noexcept {
    if (reversed_) {
        if (t > 0) return {1, forever, -infinity}; // no goal is before the start
        const Run run = runs_->at(-t);
        return {-run.end, std::max(-run.begin, t), run.value}; // also where ticks are dropped
    }
    return t < 0 ? Run{-forever, -1, infinity} : runs_->at(t);
}

double View::least(Tick l, Tick r) const noexcept {
    return turn(l, r) ? runs_->least(l, r) : infinity;
}

double View::most(Tick l, Tick r) const noexcept {
    return turn(l, r) ? runs_->most(l, r) : -infinity;
}

template <class Search>
Tick View::last(Tick l, Tick r, double value) const noexcept {
    const Tick none_there = l - 1;
    if (!turn(l, r)) return none_there;
    if (reversed_) {
        const auto found = runs_->first<Search>(l, r, value);
        return found ? -found->begin : none_there;
    }
    const auto found = runs_->last<Search>(l, r, value);
    return found ? found->end : none_there;
}

template <class Search>
Tick View::first(Tick l, Tick r, double value) const noexcept {
    const Tick none_there = r + 1;
    if (!turn(l, r)) return none_there;
    if (reversed_) {
        const auto found = runs_->last<Search>(l, r, value);
        return found ? -found->end : none_there;
    }
    const auto found = runs_->first<Search>(l, r, value);
    return found ? found->begin : none_there;
}

namespace {

// Adds the piece that ends at a tick, and returns the tick before it. It begins there at the
// latest, also where operands are not kept any more: nobody reads such ticks, but loops over them
// end.
Tick add(Pieces& pieces, Tick begin, Tick end, double value) {
    begin = std::min(begin, end);
    if (value > -infinity) pieces.push_back({begin, end, value});
    return begin - 1;
}

// The values of a register at [l, r] + shift, not more than a value.
void take(Pieces& pieces, const View& view, Tick l, Tick r, Tick shift, double most) {
    for (Tick t = l; t <= r;) {
        const Run run = view.at(plus(t, shift));
        const Tick end = std::min(plus(run.end, -shift), r);
        if (const double value = Real::meet(most, run.value); value > -infinity) {
            pieces.push_back({t, end, value});
        }
        t = end + 1;
    }
}

// The smaller of a value and the least in [t, t + length], at the ticks of a run.
void slide(Pieces& pieces, const View& view, const Run& run, Tick length) {
    for (Tick t = run.end; t >= run.begin;) {
        const double least = view.least(t, t + length);
        const double now = Real::meet(run.value, least);
        Tick begin = std::max(run.begin, view.last<Below>(run.begin, t - 1, now) + 1);
        if (least < run.value) { // until the last one that is so low leaves
            const Tick lowest = view.first<AtMost>(t, t + length, least);
            begin = std::max(begin, plus(view.at(lowest).begin, -length));
        }
        t = add(pieces, begin, t, now);
    }
}

} // namespace

// ---- a goal -------------------------------------------------------------------------------------

// The best goal from a tick on with hold before it, down to the tick `from`.
Pieces CausedUntil::untimed(const Pieces& reached, Tick from) const {
    Pieces result; // the last first
    double value = -infinity;
    auto piece = reached.rbegin();
    for (Tick t = reached.back().end; t >= from;) {
        while (piece != reached.rend() && piece->begin > t)
            ++piece;
        const bool inside = piece != reached.rend() && t <= piece->end;
        if (!inside && value == -infinity) {
            if (piece == reached.rend()) break;
            t = piece->end;
            continue;
        }
        Tick begin = from;
        if (piece != reached.rend()) {
            begin = std::max(begin, inside ? piece->begin : piece->end + 1);
        }
        const double now = inside ? piece->value : -infinity;
        const Run held = hold.at(t);
        if (kind != Kind::dense_since) {
            value = Real::join(now, Real::meet(held.value, value));
        } else {
            value = Real::meet(held.value, Real::join(now, value));
            if (value < now) begin = std::max(begin, held.begin);
        }
        if (value != now || kind == Kind::dense_since) { // until hold is worse
            begin = std::max(begin, hold.last<Below>(begin, t - 1, value) + 1);
        }
        t = add(result, begin, t, value);
    }
    std::ranges::reverse(result);
    return result;
}

// A window over the goal, the recursion from t + low on, and hold before that.
Pieces CausedUntil::by_goal(const Pieces& reached) const {
    Pieces window;
    widen(window, reached, low, high);
    envelope(window);
    const Tick from = plus(std::max(first, window.front().begin), low);
    Pieces rest = untimed(reached, from);
    if (kind == Kind::dense_since && low == 0) { // at the goal itself nothing else is required
        rest.insert(rest.end(), reached.begin(), reached.end());
        envelope(rest);
    }
    Pieces caused = both(window, shifted(std::move(rest), -low));
    if (low == 0) return caused;
    Pieces result;
    for (const Run& run : caused)
        slide(result, hold, run, kind == Kind::dense ? low : low - 1);
    return result;
}

// ---- hold ---------------------------------------------------------------------------------------

// The best goal from a tick on in the window of another tick, of which the recursion from there on
// is no better; one that never ends may contain goals that are not kept any more.
double CausedUntil::best_goal(Tick from, Tick t) const noexcept {
    return high >= forever ? infinity : goal.most(from, plus(t, high));
}

// At ticks from which hold is required up to low, or inside the run: the first instant of hold
// that counts depends on the tick.
void CausedUntil::near(Pieces& pieces, const Run& run) const {
    if (low >= step()) {
        const Tick l = std::max(first, plus(run.begin, step() - low));
        take(pieces, own, l, std::min(run.end, last), shift, run.value);
        return;
    }
    for (Tick t = std::min(run.end, last); t > std::max(first - 1, run.begin);) {
        const Run rest = core.at(t + 1);
        const double cap = Real::meet(run.value, rest.value);
        const double best = best_goal(t + 1, t);
        const double now = Real::meet(cap, best);
        Tick begin = std::max({first, run.begin + 1, rest.begin - 1});
        if (best < cap) { // until there is a better goal
            begin = std::max(begin, goal.last<Above>(begin + 1, t, best));
        }
        if (now > -infinity && high < forever) { // until the best one leaves
            const Tick highest = goal.first<AtLeast>(t + 1, plus(t, high), now);
            begin = std::max(begin, plus(goal.at(highest).begin, -high));
        }
        t = add(pieces, begin, t, now);
    }
}

// At all earlier ticks: the first instant of hold that counts is the first of the run, and for
// earlier ticks the value is no more. A run hides one behind it as soon as that is no better.
void CausedUntil::far(Pieces& pieces, const Pieces& held) const {
    struct Active {
        Run run;
        double rest; // of what comes after
        Tick from;   // the first goal
    };
    std::deque<Active> active; // the latest, and best, first
    const auto value = [&](const Active& each, Tick t) {
        const double sure = Real::meet(each.run.value, each.rest);
        return std::min({sure, hold.least(t, each.run.begin - 1), best_goal(each.from, t)});
    };
    for (std::size_t i = held.size(); i-- > 0;) {
        const Run& run = held[i];
        const Tick from = plus(run.begin, step());
        Tick t = std::min(last, plus(from, -1 - low));
        while (!active.empty() && value(active.back(), t) <= run.value)
            active.pop_back();
        active.push_back({run, core.at(from).value, from});
        const Tick until = i == 0 ? first : std::max(first, plus(held[i - 1].begin, step() - low));
        while (t >= until && !active.empty()) {
            const Active& best = active.front();
            const double now = value(best, t);
            if (now == -infinity || (active.size() > 1 && now <= active[1].run.value)) {
                active.pop_front();
                continue;
            }
            const Tick lower = hold.last<Below>(first, t - 1, now);
            Tick begin = std::max(until, lower + 1);
            if (high < forever) { // until the best goal leaves
                const Tick leaves = goal.first<AtLeast>(best.from, plus(t, high), now);
                begin = std::max(begin, plus(leaves, -high));
            }
            t = add(pieces, begin, t, now);
        }
    }
}

Pieces CausedUntil::operator()(const Pieces& held, const Pieces& reached) const {
    Pieces pieces;
    if (!reached.empty()) pieces = by_goal(reached);
    if (held.empty() || high == 0) return pieces;
    for (const Run& run : held)
        near(pieces, run);
    far(pieces, held);
    return pieces;
}

} // namespace rtamt::early
