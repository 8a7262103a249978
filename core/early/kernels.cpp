// Propagation of changes from operands to nodes. Every kernel raises one register; where a value
// rises, the maps of all operands are those after the whole change.
#include "bounds_engine.hpp"

#include <algorithm>

namespace rtamt::early {

void BoundsEngine::report(State& state, int reg, const Run& run, double now) {
    state.out[change_][static_cast<std::size_t>(reg)].push_back(
        {run.begin, run.end, run.value, now});
}

void BoundsEngine::change(State& state, int reg, Runs::Place place, Run run, double now) {
    Runs& own = state.own[static_cast<std::size_t>(reg)];
    if (journaling_) journal_.push_back({&own, run.begin, run.end, run.value});
    own.set(place, run.begin, run.end, now);
    report(state, reg, run, now);
}

void BoundsEngine::change(State& state, int reg, Run run, double now) {
    change(state, reg, state.own[static_cast<std::size_t>(reg)].find(run.begin), run, now);
}

// Raises what is below.
void BoundsEngine::lift(State& state, int reg, Tick l, Tick r, double now) {
    l = std::max(l, state.from);
    r = std::min(r, state.to);
    if (l > r || l >= forever || now == -infinity) return; // nothing reads it, or it is no rise
    const Runs& own = state.own[static_cast<std::size_t>(reg)];
    const Runs::Place place = own.find(l);
    const Run here = own.run(place);
    if (here.end >= r) { // nearly always
        if (here.value < now) change(state, reg, place, {l, r, here.value}, now);
        return;
    }
    if (!journaling_ &&
        state.own[static_cast<std::size_t>(reg)].raise(
            place, l, r, now, [&](const Run& run) { report(state, reg, run, now); }))
        return;
    while (const auto run = own.first<Below>(l, r, now)) {
        change(state, reg, *run, now);
        if (run->end >= forever) return;
        l = run->end + 1;
    }
}

// The same of one tick, with which the last run nearly always begins.
void BoundsEngine::append(State& state, int reg, Tick t, double now) {
    if (t < state.from || t > state.to) return;
    Runs& own = state.own[static_cast<std::size_t>(reg)];
    const Run rest = own.last_run();
    if (rest.begin != t || journaling_) return raise_end(state, reg, t, t, now);
    if (!(rest.value < now)) return;
    own.extend(now);
    report(state, reg, {t, t, rest.value}, now);
}

// Raises what is below where values never rise from one tick to the next.
void BoundsEngine::raise_end(State& state, int reg, Tick l, Tick r, double now) {
    const auto raised = [&](const Run& run) { report(state, reg, run, now); };
    if (journaling_ || !state.own[static_cast<std::size_t>(reg)].raise_end(l, r, now, raised)) {
        lift(state, reg, l, r, now);
    }
}

void BoundsEngine::pass(std::uint32_t index, int reg) {
    const Node& own = node(index);
    State& state = nodes_[index];
    if (state.from >= forever || state.to < 0) return; // nothing reads it
    if (new_data(own.a, reg).empty() && (own.b == none || new_data(own.b, reg).empty())) return;
    const bool greatest =
        own.kind != Kind::both && own.kind != Kind::least && own.kind != Kind::rank_least;
    const bool up = greatest == (reg == 0); // whether the register takes the greatest
    switch (own.kind) {
    case Kind::both:
    case Kind::either:
        return combine(index, reg, up);
    case Kind::least:
    case Kind::greatest:
        return slide(index, reg, up);
    case Kind::rank_least:
    case Kind::rank_greatest:
        return rank(index, reg, up);
    case Kind::pulses:
        return pulses(index, reg);
    case Kind::held:
        for (const Piece& piece : new_data(own.a, reg)) {
            const Tick l = piece.l == 0 ? 0 : plus(piece.l, -own.low);
            lift(state, reg, l, plus(piece.r, -own.low), piece.now);
        }
        return;
    default:
        break;
    }
    const Runs& hold = runs(own.a, reg);
    const Runs& goal = runs(own.b, reg);
    const auto walk = [&](const Piece& piece) {
        if (own.kind == Kind::until) {
            up ? until<true>(state, reg, hold, goal, piece.l, piece.r)
               : until<false>(state, reg, hold, goal, piece.l, piece.r);
        } else if (own.kind == Kind::since) {
            up ? since<true, false>(state, reg, hold, goal, piece.l, piece.r)
               : since<false, false>(state, reg, hold, goal, piece.l, piece.r);
        } else {
            up ? since<true, true>(state, reg, hold, goal, piece.l, piece.r)
               : since<false, true>(state, reg, hold, goal, piece.l, piece.r);
        }
    };
    const auto& of_hold = new_data(own.a, reg);
    std::ranges::for_each(of_hold, walk);
    for (const Piece& piece : new_data(own.b, reg)) {
        // A sample nearly always changes both at the same ticks, and both are looked at.
        const bool done =
            !of_hold.empty() && piece.l == of_hold.front().l && piece.r == of_hold.front().r;
        if (!done) walk(piece);
    }
}

// ---- two operands at one instant ----------------------------------------------------------------

void BoundsEngine::combine(std::uint32_t index, int reg, bool up) {
    const Node& own = node(index);
    State& state = nodes_[index];
    const Runs& a = runs(own.a, reg);
    const Runs& b = runs(own.b, reg);
    for (const std::uint32_t ref : {own.a, own.b}) {
        const auto& pieces = new_data(ref, reg);
        for (std::size_t i = 0; i < pieces.size(); ++i) {
            Piece piece = pieces[i];
            if (up) { // ticks that rise to one value at once
                for (; i + 1 < pieces.size() && pieces[i + 1].l == piece.r + 1 &&
                       pieces[i + 1].now == piece.now;
                     ++i)
                    piece.r = pieces[i + 1].r;
                piece.l == piece.r ? append(state, reg, piece.l, piece.now)
                                   : lift(state, reg, piece.l, piece.r, piece.now);
                continue;
            }
            const Run rest = (ref == own.a ? b : a).last_run();
            if (rest.begin <= piece.l && rest.value <= piece.old) continue; // the smaller is that
            // The smaller can rise only where it was this operand.
            Tick t = std::max(piece.l, state.from);
            const Tick last = std::min(piece.r, state.to);
            const Runs& mine = state.own[static_cast<std::size_t>(reg)];
            while (t <= last) {
                const Runs::Place place = mine.find(t);
                const Run run = mine.run(place);
                if (run.value < piece.old) {
                    if (run.end >= last) break;
                    const auto found = mine.first<AtLeast>(run.end + 1, last, piece.old);
                    if (!found) break;
                    t = found->begin;
                    continue;
                }
                const Run first = a.at(t);
                const Run second = b.at(t);
                const double now = Real::meet(first.value, second.value);
                const Tick end = std::min({last, run.end, first.end, second.end});
                if (now > run.value) change(state, reg, place, {t, end, run.value}, now);
                if (end >= forever) break;
                t = end + 1;
            }
        }
    }
}

// ---- windows ------------------------------------------------------------------------------------

void BoundsEngine::slide(std::uint32_t index, int reg, bool up) {
    const Node& own = node(index);
    State& state = nodes_[index];
    const Runs& operand = runs(own.a, reg);
    for (const Piece& piece : new_data(own.a, reg)) {
        if (of_row_ && node(own.a / 2).kind == Kind::atom && own.low > -forever) {
            up ? raise_of_row(state, reg, own, piece)
               : slide_of_row(state, reg, own, operand, piece);
        } else if (up) {
            lift(state, reg, plus(piece.l, -own.high), plus(piece.r, -own.low), piece.now);
        } else if (own.low <= -forever) { // where the run of the operand began may be forgotten
            run_least(state, reg, own, operand, piece);
        } else {
            slide_piece(state, reg, own, operand, piece);
        }
    }
}

void BoundsEngine::slide_piece(State& state, int reg, const Node& node, const Runs& operand,
                               Piece piece) {
    truths_[node.a / 2] ? slide_truth(state, reg, node, operand, piece)
                        : slide_least(state, reg, node, operand, piece);
}

// What a piece of truth decides are the windows that lie in its run.
void BoundsEngine::slide_truth(State& state, int reg, const Node& node, const Runs& operand,
                               Piece piece) {
    const Run run = operand.at(piece.l);
    const Tick l = run.begin <= 0 ? 0 : plus(run.begin, -node.low);
    const Tick r = plus(run.end, -node.high);
    lift(state, reg, std::max(l, plus(piece.l, -node.high)), std::min(r, plus(piece.r, -node.low)),
         piece.now);
}

// The least value of a window can rise only where it was that of the piece and no other value in
// the window is as small; the new one holds for as long as it stays in the window and nothing
// smaller comes in.
void BoundsEngine::slide_least(State& state, int reg, const Node& node, const Runs& operand,
                               Piece piece) {
    const Runs& own = state.own[static_cast<std::size_t>(reg)];
    Tick t = std::max(state.from, plus(piece.l, -node.high));
    Tick last = std::min(state.to, plus(piece.r, -node.low));
    if (const Run mine = own.at(t); mine.end >= last && mine.value < piece.old) return;
    if (piece.r < plus(last, node.high)) {
        const Run next = operand.at(piece.r + 1); // nearly always beyond what was read
        if (next.value <= piece.old) {
            last = std::min(last, piece.r - node.high);
        } else if (const auto after =
                       operand.first<AtMost>(plus(next.end, 1), plus(last, node.high), piece.old)) {
            last = std::min(last, after->begin - 1 - node.high);
        }
    }
    if (last < t) return;
    if (piece.l > std::max<Tick>(0, plus(t, node.low)) &&
        operand.at(piece.l - 1).value <= piece.old) {
        t = std::max(t, piece.l - node.low);
    }
    while (const auto run = own.first<AtLeast>(t, last, piece.old)) {
        t = run->begin;
        const Tick begin = std::max<Tick>(0, plus(t, node.low));
        const Tick end = plus(t, node.high);
        const double now = operand.least(begin, end, piece.old);
        Tick until = run->end;
        if (until > t) {
            // The last run in the window that is as small, and until when it stays there.
            const auto holder = operand.last<AtMost>(begin, end, now);
            const Tick stays = holder ? plus(operand.at(holder->end).end, -node.low) : t;
            until = std::min(until, stays);
        }
        if (now > run->value) {
            if (until > t && end < forever) {
                const auto next = operand.first<Below>(end + 1, plus(until, node.high), now);
                if (next) until = std::min(until, next->begin - 1 - node.high);
            }
            change(state, reg, {t, until, run->value}, now);
        }
        if (until >= forever) return;
        t = until + 1;
    }
}

// The least value since the start: min(own value before, the operand now).
void BoundsEngine::run_least(State& state, int reg, const Node& node, const Runs& operand,
                             Piece piece) {
    const Runs& own = state.own[static_cast<std::size_t>(reg)];
    Tick t = std::max(state.from, plus(piece.l, -node.high));
    while (const auto run = own.first<AtLeast>(t, state.to, piece.old)) {
        t = run->begin;
        const bool first = t + node.high <= 0; // the first operand in the window
        const Run entering = operand.at(t + node.high);
        const double before = first ? infinity : own.at(t - 1).value;
        const double now = Real::meet(before, entering.value);
        if (!(now > run->value)) return; // nor do later ones rise
        const Tick until = std::min(run->end, plus(entering.end, -node.high));
        change(state, reg, {t, until, run->value}, now);
        if (until >= forever) return;
        t = until + 1;
    }
}

// ---- recursions ---------------------------------------------------------------------------------

// From the right: max(goal, min(hold, next)), or the dual. A stretch on which hold and goal let the
// next value through is passed at once.
template <bool up>
void BoundsEngine::until(State& state, int reg, const Runs& hold, const Runs& goal, Tick l,
                         Tick r) {
    using Less = std::conditional_t<up, Below, Above>;
    using More = std::conditional_t<up, Above, Below>;
    const Runs& own = state.own[static_cast<std::size_t>(reg)];
    double next = up ? -infinity : infinity;
    if (r < forever) next = own.at(r + 1).value;
    for (Tick t = r; t >= state.from;) {
        const Run held = hold.at(t);
        const Run wanted = goal.at(t);
        const Run mine = own.at(t);
        Tick begin = std::max(mine.begin, state.from);
        double now = next;
        if (!Less::holds(held.value, next) && !More::holds(wanted.value, next)) {
            if (const auto stop = hold.last<Less>(begin, t, next)) {
                begin = std::max(begin, stop->end + 1);
            }
            if (const auto stop = goal.last<More>(begin, t, next)) {
                begin = std::max(begin, stop->end + 1);
            }
        } else {
            begin = std::max({begin, held.begin, wanted.begin});
            now = up ? Real::join(wanted.value, Real::meet(held.value, next))
                     : Real::meet(wanted.value, Real::join(held.value, next));
        }
        if (now > mine.value) {
            change(state, reg, {begin, t, mine.value}, now);
        } else if (begin <= l) {
            return;
        }
        next = now;
        t = begin - 1;
    }
}

// From the left: max(goal, min(hold, before)), of dense time min(hold, max(goal, before)).
template <bool up, bool dense>
void BoundsEngine::since(State& state, int reg, const Runs& hold, const Runs& goal, Tick l,
                         Tick r) {
    using Less = std::conditional_t<up, Below, Above>;
    using More = std::conditional_t<up, Above, Below>;
    const auto join = [](double a, double b) { return up ? Real::join(a, b) : Real::meet(a, b); };
    const auto meet = [](double a, double b) { return up ? Real::meet(a, b) : Real::join(a, b); };
    const Runs& own = state.own[static_cast<std::size_t>(reg)];
    if (r < state.from) return;
    Tick t = std::max(l, state.from);
    double before = t == 0 ? (up ? -infinity : infinity) : own.at(t - 1).value;
    for (;;) {
        const Run held = hold.at(t);
        const Run wanted = goal.at(t);
        const Run mine = own.at(t);
        Tick end = mine.end;
        double now = before;
        if (!Less::holds(held.value, before) && !More::holds(wanted.value, before)) {
            if (const auto stop = hold.first<Less>(t, end, before)) {
                end = std::min(end, stop->begin - 1);
            }
            if (const auto stop = goal.first<More>(t, end, before)) {
                end = std::min(end, stop->begin - 1);
            }
        } else {
            end = std::min({end, held.end, wanted.end});
            now = dense ? meet(held.value, join(wanted.value, before))
                        : join(wanted.value, meet(held.value, before));
        }
        if (now > mine.value) {
            change(state, reg, {t, end, mine.value}, now);
        } else if (end >= r) {
            return;
        }
        if (end >= forever) return;
        before = now;
        t = end + 1;
    }
}

} // namespace rtamt::early
