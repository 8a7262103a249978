// New knowledge of the inputs: atoms and maps are recomputed where it may change them.
#include "bounds_engine.hpp"

#include <algorithm>
#include <type_traits>

namespace rtamt::early {

template <class Value>
std::optional<BoundsEngine::Failure> BoundsEngine::take(Tick t, std::span<const Value> values) {
    settle_inputs(t);
    begin(t);
    journaling_ = fallible_ || awaited_;
    if (const auto failure = put(t, values, atoms_)) return attempt(failure);
    return attempt(propagate_row());
}

// Every atom is computed before anything changes.
template <class Value>
std::optional<BoundsEngine::Failure> BoundsEngine::put(Tick t, std::span<const Value> values,
                                                       std::span<const std::uint32_t> atoms) {
    const auto scratch = [&] {
        if constexpr (std::is_same_v<Value, double>) {
            return std::span(exact_);
        } else {
            return std::span(bounds_);
        }
    }();
    for (const std::uint32_t i : atoms) {
        const auto& steps = node(i).steps;
        const std::uint32_t wrong = run<Value>(steps, values, scratch);
        if (wrong != none) return Failure{i, wrong, t};
        if constexpr (std::is_same_v<Value, double>) {
            results_[i] = Interval::of(scratch[steps.size() - 1]);
        } else {
            results_[i] = scratch[steps.size() - 1];
        }
    }
    for (const std::uint32_t i : atoms) {
        append(nodes_[i], 0, t, results_[i].lower);
        append(nodes_[i], 1, t, -results_[i].upper);
    }
    return std::nullopt;
}

std::optional<BoundsEngine::Failure>
BoundsEngine::late_row(Tick t, std::span<const Bounds> values,
                       std::span<const std::uint32_t> changed) {
    begin(t);
    journaling_ = fallible_ || awaited_;
    std::span<const std::uint32_t> atoms(atoms_);
    if (changed.size() < values.size()) {
        touched_.clear();
        for (const std::uint32_t input : changed)
            touched_.insert(touched_.end(), readers_[input].begin(), readers_[input].end());
        std::ranges::sort(touched_);
        touched_.erase(std::ranges::unique(touched_).begin(), touched_.end());
        atoms = touched_;
    }
    bool exact = true;
    for (std::size_t i = 0; i < values.size(); ++i) {
        numbers_[i] = values[i].lower;
        exact = exact && values[i].lower == values[i].upper;
    }
    const auto failure = exact ? put<double>(t, numbers_, atoms) : put<Bounds>(t, values, atoms);
    if (failure) { // whether that is an error depends on what may still come
        journaling_ = true;
        std::ranges::copy(values, row_.begin());
        for (const std::uint32_t i : atoms)
            assess(i, t, t, false);
    }
    return attempt(propagate_row());
}

bool BoundsEngine::is_defined(std::span<const Bounds> values) noexcept {
    if (!partial_) return true;
    return !awaited_ && !fallible_ && std::ranges::all_of(atoms_, [&](std::uint32_t i) {
        return run<Bounds>(node(i).steps, values, bounds_) == none;
    });
}

std::optional<BoundsEngine::Failure> BoundsEngine::row(Tick t, std::span<const double> values) {
    return take(t, values);
}

std::optional<BoundsEngine::Failure> BoundsEngine::row(Tick t, std::span<const Bounds> values) {
    return take(t, values);
}

void BoundsEngine::know(std::span<const Observation> observations) {
    for (const auto& [input, l, r, bounds] : observations) {
        StepMap<Bounds>& own = inputs_[input];
        for (Tick t = l; t <= r;) {
            const auto place = own.find(t);
            const auto run = own.run(place);
            const Tick end = std::min(run.end, r);
            Bounds now = run.value;
            if (now.lower < bounds.lower) now.lower = bounds.lower;
            if (now.upper > bounds.upper) now.upper = bounds.upper;
            if (!(now == run.value)) {
                if (journaling_) input_journal_.push_back({input, {t, end, run.value}});
                own.set(place, t, end, now);
            }
            if (end >= forever) break;
            t = end + 1;
        }
    }
}

// What atoms make of observations, all of which are known already. One that reads several of the
// same ticks, which are close to each other, is computed once.
void BoundsEngine::relearn(std::span<const Observation> observations, bool supposed) {
    for (std::size_t k = 0; k < observations.size(); ++k) {
        const auto& [input, l, r, bounds] = observations[k];
        for (const std::uint32_t i : readers_[input]) {
            const auto did = [&](const Observation& before) {
                return before.l == l && before.r == r && reads(2 * i, before.input);
            };
            constexpr std::size_t close = 16;
            const std::size_t from = k < close ? 0 : k - close;
            if (std::ranges::any_of(observations.subspan(from, k - from), did)) continue;
            relearn(i, l, r, supposed);
        }
    }
}

std::optional<BoundsEngine::Failure> BoundsEngine::learn(std::span<const Observation> observations,
                                                         Tick newest, bool ended) {
    begin(newest);
    ended_ = ended;
    journaling_ = partial_ || keeps_undo_;
    know(observations);
    relearn(observations, false);
    return attempt(propagate(false));
}

std::optional<BoundsEngine::Failure>
BoundsEngine::suppose(std::span<const Supposition> suppositions) {
    begin(seen_);
    for (const Supposition& supposed : suppositions)
        if (supposed.r < forever) summed_ = std::max(summed_, supposed.r);
    journaling_ = true;
    for (const Supposition& supposed : suppositions) {
        for (const std::uint32_t i : atoms_) {
            if (run<Bounds>(node(i).steps, supposed.row, bounds_) != none) continue; // not known
            const Bounds result = bounds_[node(i).steps.size() - 1];
            lift(nodes_[i], 0, supposed.l, supposed.r, result.lower);
            lift(nodes_[i], 1, supposed.l, supposed.r, -result.upper);
        }
    }
    return attempt(propagate(false));
}

std::optional<BoundsEngine::Failure>
BoundsEngine::suppose(std::span<const Observation> observations) {
    begin(seen_);
    journaling_ = true;
    know(observations);
    relearn(observations, true);
    return attempt(propagate(false));
}

std::optional<BoundsEngine::Failure> BoundsEngine::wrong_constant() {
    for (const std::uint32_t i : atoms_) {
        const auto reads = [](const Step& step) { return step.opcode == Opcode::input; };
        if (std::ranges::any_of(node(i).steps, reads)) continue;
        const std::uint32_t wrong = run<Bounds>(node(i).steps, row_, bounds_);
        if (wrong != none) return Failure{i, wrong, 0};
    }
    return std::nullopt;
}

// Computes an atom again wherever its inputs may have changed.
void BoundsEngine::relearn(std::uint32_t index, Tick l, Tick r, bool supposed) {
    for (Tick t = std::max(l, nodes_[index].from); t <= r;) {
        Tick end = r;
        for (const Step& step : node(index).steps) {
            if (step.opcode != Opcode::input) continue;
            if (inputs_.empty()) {
                row_[step.a] = ranges_[step.a];
                continue;
            }
            const auto known = inputs_[step.a].at(t);
            row_[step.a] = known.value;
            end = std::min(end, known.end);
        }
        assess(index, t, end, supposed);
        if (end >= forever) break;
        t = end + 1;
    }
}

// Computes an atom where a row of inputs holds.
void BoundsEngine::assess(std::uint32_t index, Tick l, Tick r, bool supposed) {
    const auto& steps = node(index).steps;
    const Wrong wrong = enclose(steps, row_, bounds_);
    if (wrong.any != none && !supposed) {
        if (wrong.any != wrong.exact) has_no_value(index, wrong.any, l, false);
        if (wrong.exact != none) has_no_value(index, wrong.exact, l, true);
    }
    const Bounds result = bounds_[steps.size() - 1];
    lift(nodes_[index], 0, l, r, result.lower);
    lift(nodes_[index], 1, l, r, -result.upper);
}

void BoundsEngine::remap(std::uint32_t index, Tick l, Tick r) {
    State& state = nodes_[index];
    const Node& map = node(index);
    const std::uint32_t b = map.b == none ? map.a : map.b;
    for (Tick t = std::max(l, state.from); t <= r;) {
        const Run ends[] = {runs(map.a, 0).at(t), runs(map.a, 1).at(t), runs(b, 0).at(t),
                            runs(b, 1).at(t)};
        const Tick end = std::min({r, ends[0].end, ends[1].end, ends[2].end, ends[3].end});
        const Bounds first{ends[0].value, -ends[1].value};
        const Bounds second{ends[2].value, -ends[3].value};
        const Bounds result = compute(map.steps.front().opcode, first, second);
        if (!Interval::undefined(result)) {
            lift(state, 0, t, end, result.lower);
            lift(state, 1, t, end, -result.upper);
        } else {
            has_no_value(index, 0, t, first.lower == first.upper && second.lower == second.upper);
        }
        if (end >= forever) break;
        t = end + 1;
    }
}

// At the start of the trace nothing is in a window of the past yet, or too little for a rank.
void BoundsEngine::lift_empty(std::uint32_t index) {
    const Node& own = node(index);
    const bool rank = own.kind == Kind::rank_least || own.kind == Kind::rank_greatest;
    Tick ticks = own.kind == Kind::held ? 0 : -own.high;
    if (rank && own.low < 0) ticks += static_cast<Tick>(own.steps.front().x) - 1;
    if (ticks <= 0) return;
    const bool least = own.kind == Kind::least || own.kind == Kind::rank_least;
    double empty = least ? infinity : -infinity;
    if (own.kind == Kind::pulses) empty = 0.0;
    lift(nodes_[index], 0, 0, ticks - 1, empty);
    lift(nodes_[index], 1, 0, ticks - 1, -empty);
}

// Lets every node look at what its operands have changed. `first`: at what they are.
std::optional<BoundsEngine::Failure> BoundsEngine::propagate(bool first) {
    for (std::uint32_t i = 0; i < nodes_.size(); ++i) {
        const Node& own = node(i);
        if (awaited_ && !first) {
            if (const auto failure = fails(i)) return failure;
        }
        if (own.kind == Kind::atom) {
            if (first) relearn(i, 0, forever);
        } else if (own.kind == Kind::map) {
            if (first) remap(i, 0, forever);
            for (int reg = 0; reg < 2 && !first; ++reg) {
                for (const std::uint32_t ref : {own.a, own.b}) {
                    if (ref == none) continue;
                    for (const Piece& piece : new_data(ref, reg))
                        remap(i, piece.l, piece.r);
                }
            }
            if (awaited_ && !first) { // the earliest of all pieces, which come in any order
                if (const auto failure = fails(i)) return failure;
            }
        } else if (own.kind == Kind::sum) {
            const auto failure = add_up(i, first);
            if (failure && !first) return failure;
        } else {
            if (first) lift_empty(i);
            pass(i, 0);
            pass(i, 1);
        }
    }
    return std::nullopt;
}

} // namespace rtamt::early
