// Windows over atoms that learn from rows: all inputs at one tick, nearly always the newest one.
//
// The least value of a window is what was known before any sample came until the last of its ticks
// that nothing is known of is seen. So the values of an atom are read in the order of time, up to
// the first such tick, and the windows that end there are computed from the values in them. A tick
// that stays unseen is passed when no sample of it can arrive, or when windows fit behind it.
//
// Cost: amortised constant for each row. A row that makes a value known better that was read
// already is followed as any other change, and so are as many after it as there are ticks in the
// window; then all are read again.
#include "bounds_engine.hpp"

#include <algorithm>

namespace rtamt::early {

std::optional<BoundsEngine::Failure> BoundsEngine::propagate_row() {
    of_row_ = true;
    const auto failure = propagate(false);
    of_row_ = false;
    for (std::size_t i = 0; failure && i < nodes_.size(); ++i) {
        nodes_[i].slid = unread;
        nodes_[i].wait = 0;
    }
    return failure;
}

// From the first window on that contains the newest tick, each contains fewer samples than the one
// before: their greatest values never rise.
void BoundsEngine::raise_of_row(State& state, int reg, const Node& node, Piece piece) {
    Tick l = std::max(state.from, piece.l - node.high);
    const Tick r = std::min(state.to, piece.r - node.low);
    if (const Tick newest = seen_ - node.high; l < newest) {
        lift(state, reg, l, std::min(r, newest - 1), piece.now);
        l = newest;
    }
    if (l <= r) raise_end(state, reg, l, r, piece.now);
}

// Up to which tick what is unseen is passed.
Tick BoundsEngine::passed(const Node& node) const noexcept {
    return std::max(complete_, seen_ - (node.high - node.low) - 1);
}

void BoundsEngine::slide_of_row(State& state, int reg, const Node& node, const Runs& operand,
                                Piece piece) {
    if (state.slid == unread) {
        slide_piece(state, reg, node, operand, piece);
        if (state.wait > 0) {
            --state.wait;
        } else {
            read_values(state, node, operand);
        }
    } else if (piece.l <= state.slid) {
        slide_piece(state, reg, node, operand, piece);
        state.slid = unread;
        state.wait = node.high - node.low;
    } else if (piece.l == state.slid + 1) {
        add_value(state, reg, node, piece.l, piece.now);
        state.slid = piece.l;
        if (state.slid < seen_) add_values(state, reg, node, operand);
    } else if (state.slid < passed(node)) {
        add_values(state, reg, node, operand);
    }
}

void BoundsEngine::add_value(State& state, int reg, const Node& node, Tick t, double value) {
    state.values.add(t, value);
    const Tick window = t - node.high;
    if (window >= 0) append(state, reg, window, state.values.from(window + node.low));
}

// Reads on, up to a tick that may still be seen.
void BoundsEngine::add_values(State& state, int reg, const Node& node, const Runs& operand) {
    const double unseen = operand.last_run().value;
    while (state.slid < seen_) {
        const Run run = operand.at(state.slid + 1);
        Tick end = std::min(run.end, seen_);
        if (run.value > unseen) {
            for (Tick t = state.slid + 1; t <= end; ++t)
                add_value(state, reg, node, t, run.value);
        } else {
            end = std::min(end, passed(node));
            if (end <= state.slid) return;
            state.values.add(end, run.value);
        }
        state.slid = end;
    }
}

// The same of what was read before, and of no window.
void BoundsEngine::read_values(State& state, const Node& node, const Runs& operand) {
    const double unseen = operand.last_run().value;
    const Tick certain = passed(node);
    state.values.clear();
    state.slid = std::max<Tick>(0, certain - (node.high - node.low)) - 1;
    while (state.slid < seen_) {
        const Run run = operand.at(state.slid + 1);
        Tick end = std::min(run.end, seen_);
        if (!(run.value > unseen)) end = std::min(end, certain);
        if (end <= state.slid) return;
        state.values.add(end, run.value);
        state.slid = end;
    }
}

} // namespace rtamt::early
