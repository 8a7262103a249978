// Propagation of changes to the number of pulses in a window.
#include "bounds_engine.hpp"

#include <algorithm>

namespace rtamt::early {

namespace {

// From a tick on, by how many the runs change of which the window meets one tick, and several.
struct Shift {
    Tick tick;
    std::int64_t single;
    std::int64_t several;
};

// The steps that a run of positive ticks makes; an open window is never left.
void add_steps(std::vector<Shift>& steps, const Run& run, const Node& node) {
    const bool open = node.low <= -forever;
    steps.push_back({plus(run.begin, -node.high), 1, 0});
    const Tick gone = open || run.end >= forever ? forever : plus(run.end, 1 - node.low);
    if (run.end > run.begin && node.high > node.low) {
        steps.push_back({plus(run.begin, 1 - node.high), -1, 1});
        if (gone < forever) steps.push_back({gone - 1, 1, -1});
    }
    if (gone < forever) steps.push_back({gone, -1, 0});
}

} // namespace

// Looks again at every tick whose window meets a piece, in one pass over the runs there. A sum
// since the start goes on from the tick before, at which no pulse of several ticks is cut: what is
// known there is known for good, or the piece begins a run.
void BoundsEngine::pulses(std::uint32_t index, int reg) {
    const Node& own = node(index);
    State& state = nodes_[index];
    const Runs& operand = runs(own.a, reg);
    Tick t = forever;
    Tick last = 0;
    for (const Piece& piece : new_data(own.a, reg)) {
        t = std::min(t, plus(piece.l, -own.high));
        last = std::max(last, plus(piece.r, -own.low));
    }
    t = std::max(t, state.from);
    last = std::min(last, state.to);
    if (t > last || t >= forever) return;
    const bool open = own.low <= -forever;
    Tick from = std::max<Tick>(0, t + (open ? own.high : own.low));
    const Tick end = plus(last, own.high);
    std::vector<Shift> steps;
    while (const auto run = reg == 0 ? operand.first<Above>(from, end, 0.0)
                                     : operand.first<Below>(from, end, 0.0)) {
        add_steps(steps, *run, own);
        if (run->end >= end) break;
        from = run->end + 1;
    }
    std::ranges::sort(steps, {}, &Shift::tick);
    const double sign = reg == 0 ? 1.0 : -1.0;
    const Runs& mine = state.own[static_cast<std::size_t>(reg)];
    const double before = open && t + own.high > 0 ? sign * mine.at(t - 1).value : 0.0;
    std::int64_t single = 0;
    std::int64_t several = 0;
    for (std::size_t i = 0; t <= last;) {
        for (; i < steps.size() && steps[i].tick <= t; ++i) {
            single += steps[i].single;
            several += steps[i].several;
        }
        const Tick next = i < steps.size() ? steps[i].tick : forever;
        const double count = several != 0 ? infinity : before + static_cast<double>(single);
        lift(state, reg, t, next >= forever ? last : std::min(last, next - 1), sign * count);
        if (next >= forever) return;
        t = next;
    }
}

} // namespace rtamt::early
