#include "engine.hpp"

#include "../program/snapshot.hpp"

#include <algorithm>
#include <ranges>
#include <type_traits>
#include <utility>

namespace rtamt::early {

Engine::Engine(Graph graph, std::vector<Bounds> ranges, bool late)
    : graph_(std::move(graph)), ranges_(std::move(ranges)), late_(late),
      nodes_(graph_.nodes.size()), settled_(graph_.inputs, -1), readers_(graph_.inputs),
      results_(graph_.nodes.size()), row_(graph_.inputs) {
    graph_.check();
    truths_ = graph_.truths();
    ranges_.resize(graph_.inputs, bounds::anything);
    std::size_t steps = 0;
    for (std::uint32_t i = 0; i < graph_.nodes.size(); ++i) {
        steps = std::max(steps, node(i).steps.size());
        totals_.emplace_back(plus(node(i).high, plus(-node(i).low, 1)));
        if (node(i).kind == Kind::atom) atoms_.push_back(i);
        for (const Step& step : node(i).steps) {
            partial_ = partial_ || info(step.opcode).partial;
            if (node(i).kind != Kind::atom || step.opcode != Opcode::input) continue;
            auto& readers = readers_[step.a];
            if (readers.empty() || readers.back() != i) readers.push_back(i);
        }
    }
    exact_.resize(steps);
    bounds_.resize(steps);
    if (late_) {
        for (const Bounds& range : ranges_)
            inputs_.push_back({Runs(0, range.lower), Runs(0, -range.upper)});
    }
    find_beyond({});
    (void)propagate(true); // what has no value before it is seen is not known
    clear();
}

Bounds Engine::known(std::uint32_t input, Tick t) const noexcept {
    if (!late_) return ranges_[input];
    return {inputs_[input][0].at(t).value, -inputs_[input][1].at(t).value};
}

Bounds Engine::at(std::uint32_t ref, Tick t) const noexcept {
    return {runs(ref, 0).at(t).value, -runs(ref, 1).at(t).value};
}

Tick Engine::reach() const noexcept {
    Tick sum = 0;
    for (const Node& node : graph_.nodes) {
        for (const Tick bound : {node.low, node.high}) {
            if (bound > -forever && bound < forever) sum = plus(sum, bound < 0 ? -bound : bound);
        }
    }
    return sum;
}

// A change, with samples up to a tick.
void Engine::begin(Tick newest) noexcept {
    clear();
    seen_before_ = seen_;
    seen_ = std::max(seen_, newest);
    if (!partial_) return;
    for (State& state : nodes_)
        state.undefined_before = state.undefined;
}

void Engine::clear() noexcept {
    for (State& state : nodes_) {
        state.out[0].clear();
        state.out[1].clear();
    }
    journal_.clear();
}

// Takes everything back if something failed.
std::optional<Engine::Failure> Engine::attempt(std::optional<Failure> failure) {
    if (failure) revert();
    return failure;
}

void Engine::revert() {
    for (const Undo& undo : std::views::reverse(journal_))
        undo.runs->set(undo.l, undo.r, undo.old);
    for (Totals& totals : totals_)
        totals.forget();
    for (State& state : nodes_)
        state.undefined = state.undefined_before;
    seen_ = seen_before_;
    ended_ = false;
    clear();
}

// ---- knowledge ----------------------------------------------------------------------------------

// Every atom is computed before anything changes.
template <class Value>
std::optional<Engine::Failure> Engine::take(Tick t, std::span<const Value> values) {
    begin(t);
    const auto scratch = [&] {
        if constexpr (std::is_same_v<Value, double>) {
            return std::span(exact_);
        } else {
            return std::span(bounds_);
        }
    }();
    for (const std::uint32_t i : atoms_) {
        const auto& steps = node(i).steps;
        const std::uint32_t wrong = run<Value>(steps, values, scratch);
        if (wrong != none) return Failure{i, wrong, t};
        if constexpr (std::is_same_v<Value, double>) {
            results_[i] = Interval::of(scratch[steps.size() - 1]);
        } else {
            results_[i] = scratch[steps.size() - 1];
        }
    }
    journaling_ = partial_;
    for (const std::uint32_t i : atoms_) {
        lift(nodes_[i], 0, t, t, results_[i].lower);
        lift(nodes_[i], 1, t, t, -results_[i].upper);
    }
    return attempt(propagate(false));
}

std::optional<Engine::Failure> Engine::row(Tick t, std::span<const double> values) {
    return take(t, values);
}

std::optional<Engine::Failure> Engine::row(Tick t, std::span<const Bounds> values) {
    return take(t, values);
}

void Engine::know(std::span<const Observation> observations) {
    for (const Observation& observation : observations) {
        for (int reg = 0; reg < 2; ++reg) {
            Runs& own = inputs_[observation.input][static_cast<std::size_t>(reg)];
            const double now = reg == 0 ? observation.bounds.lower : -observation.bounds.upper;
            while (const auto run = own.first<Below>(observation.l, observation.r, now)) {
                if (journaling_) journal_.push_back({&own, run->begin, run->end, run->value});
                own.set(run->begin, run->end, now);
            }
        }
    }
}

std::optional<Engine::Failure> Engine::learn(std::span<const Observation> observations, Tick newest,
                                             bool ended) {
    begin(newest);
    ended_ = ended;
    journaling_ = partial_;
    know(observations);
    for (const Observation& observation : observations) {
        for (const std::uint32_t i : readers_[observation.input]) {
            const auto failure = relearn(i, observation.l, observation.r);
            if (failure) return attempt(failure);
        }
    }
    return attempt(propagate(false));
}

std::optional<Engine::Failure> Engine::suppose(std::span<const Supposition> suppositions) {
    begin(seen_);
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

std::optional<Engine::Failure> Engine::suppose(std::span<const Observation> observations) {
    begin(seen_);
    journaling_ = true;
    know(observations);
    for (const Observation& observation : observations) {
        for (const std::uint32_t i : readers_[observation.input])
            (void)relearn(i, observation.l, observation.r, true);
    }
    return attempt(propagate(false));
}

std::optional<Engine::Failure> Engine::wrong_constant() {
    for (const std::uint32_t i : atoms_) {
        const auto reads = [](const Step& step) { return step.opcode == Opcode::input; };
        if (std::ranges::any_of(node(i).steps, reads)) continue;
        const std::uint32_t wrong = run<Bounds>(node(i).steps, row_, bounds_);
        if (wrong != none) return Failure{i, wrong, 0};
    }
    return std::nullopt;
}

// Computes an atom again wherever its inputs may have changed. It fails where its operands are
// known exactly, or will not be known better; what has no value for other operands, or for those
// that are only supposed, may still get one. Behind the newest sample no operand is known that has
// no such value at that sample too.
std::optional<Engine::Failure> Engine::relearn(std::uint32_t index, Tick l, Tick r, bool supposed) {
    State& state = nodes_[index];
    const auto& steps = node(index).steps;
    for (Tick t = std::max(l, state.from); t <= r;) {
        Tick end = r;
        bool exact = true;
        for (const Step& step : steps) {
            if (step.opcode != Opcode::input) continue;
            Bounds& value = row_[step.a];
            value = ranges_[step.a];
            if (late_) {
                const Run lower = inputs_[step.a][0].at(t);
                const Run upper = inputs_[step.a][1].at(t);
                value = {lower.value, -upper.value};
                end = std::min({end, lower.end, upper.end});
            }
            const Tick settled = settled_[step.a];
            if (t <= settled) {
                end = std::min(end, settled);
            } else {
                exact = exact && value.lower == value.upper;
            }
        }
        const std::uint32_t wrong = enclose(steps, row_, bounds_);
        if (wrong != none && exact && !supposed && t <= seen_) return Failure{index, wrong, t};
        const Bounds result = bounds_[steps.size() - 1];
        lift(state, 0, t, end, result.lower);
        lift(state, 1, t, end, -result.upper);
        if (end >= forever) break;
        t = end + 1;
    }
    return std::nullopt;
}

std::optional<Engine::Failure> Engine::remap(std::uint32_t index, Tick l, Tick r) {
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
        } else if (first.lower == first.upper && second.lower == second.upper) {
            if (const auto failure = fails(index, t)) return failure;
        }
        if (end >= forever) break;
        t = end + 1;
    }
    return std::nullopt;
}

// At the start of the trace nothing is in a window of the past yet, or too little for a rank.
void Engine::lift_empty(std::uint32_t index) {
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
std::optional<Engine::Failure> Engine::propagate(bool first) {
    for (std::uint32_t i = 0; i < nodes_.size(); ++i) {
        const Node& own = node(i);
        if (own.kind == Kind::atom) {
            if (first) (void)relearn(i, 0, forever);
        } else if (own.kind == Kind::map) {
            if (reached(i, nodes_[i].undefined)) return Failure{i, 0, nodes_[i].undefined};
            std::optional<Failure> failure;
            if (first) failure = remap(i, 0, forever);
            for (int reg = 0; reg < 2 && !first; ++reg) {
                for (const std::uint32_t ref : {own.a, own.b}) {
                    if (ref == none) continue;
                    for (const Piece& piece : new_data(ref, reg)) {
                        if (!failure) failure = remap(i, piece.l, piece.r);
                    }
                }
            }
            if (failure && !first) return failure;
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

// ---- what is not needed, or not any more
// ----------------------------------------------------------------

// An operation that may have no value is followed wherever it is, needed or not: whether a sample
// is an error must not depend on what is already decided.
bool Engine::may_fail(const Node& node) noexcept {
    return (node.kind == Kind::map || node.kind == Kind::sum) &&
           info(node.steps.front().opcode).partial;
}

void Engine::limit(std::span<const Tick> last) {
    std::vector<Tick> to(last.begin(), last.end());
    for (std::size_t i = nodes_.size(); i-- > 0;) {
        const Node& own = node(i);
        if (may_fail(own) ||
            (own.kind == Kind::until && to[i] >= 0)) { // which reads its next value
            to[i] = forever;
        }
        nodes_[i].to = to[i];
        if (own.kind == Kind::atom || to[i] < 0) continue;
        const Tick read = std::max<Tick>(0, plus(to[i], own.high));
        for (const std::uint32_t ref : {own.a, own.b})
            if (ref != none) to[ref / 2] = std::max(to[ref / 2], read);
    }
}

void Engine::settle(Tick closed, std::span<const Tick> wanted) {
    std::vector<Tick> need(wanted.begin(), wanted.end());
    std::vector<Tick> input(graph_.inputs, forever);
    for (std::size_t i = nodes_.size(); i-- > 0;) {
        const Node& own = node(i);
        State& state = nodes_[i];
        const bool recursive =
            own.kind == Kind::since || own.kind == Kind::since_dense || own.low <= -forever;
        Tick open = std::max<Tick>(0, plus(plus(closed, 1), -own.horizon));
        if (own.kind == Kind::sum) open = std::min(open, seen_ + 1); // samples may be left out
        if (may_fail(own)) need[i] = std::min(need[i], open);
        Tick from = recursive ? open : std::max(need[i], open);
        if (need[i] >= forever) from = forever;
        state.from = std::max(state.from, from);
        state.keep = std::max(state.keep, std::min(need[i], from) - (recursive ? 1 : 0));
        const auto want = [&](std::uint32_t ref, Tick t) {
            if (ref != none) need[ref / 2] = std::min(need[ref / 2], std::max<Tick>(0, t));
        };
        switch (own.kind) {
        case Kind::atom:
            for (const Step& step : own.steps) {
                if (step.opcode == Opcode::input) input[step.a] = std::min(input[step.a], from);
            }
            break;
        case Kind::least:
        case Kind::greatest:
        case Kind::sum:
        case Kind::rank_least:
        case Kind::rank_greatest:
        case Kind::pulses:
            want(own.a, plus(from, own.low <= -forever ? own.high : own.low));
            break;
        case Kind::held: // the trace may end now, so that the last value is wanted
            want(own.a, std::min(plus(from, own.low), closed));
            break;
        default:
            want(own.a, from);
            want(own.b, from);
        }
        for (Runs& runs : state.own)
            runs.drop_before(state.keep);
    }
    if (!late_) return;
    for (std::size_t i = 0; i < inputs_.size(); ++i) {
        for (Runs& runs : inputs_[i])
            runs.drop_before(std::min(input[i], plus(closed, 1)));
    }
}

std::size_t Engine::bytes() const noexcept {
    std::size_t sum = 0;
    for (const State& state : nodes_)
        sum += state.own[0].bytes() + state.own[1].bytes();
    for (const Registers& registers : inputs_)
        sum += registers[0].bytes() + registers[1].bytes();
    return sum;
}

void Engine::transfer(Snapshot& snapshot) {
    for (State& state : nodes_) {
        state.own[0].transfer(snapshot);
        state.own[1].transfer(snapshot);
        snapshot.item(state.from);
        snapshot.item(state.keep);
        snapshot.item(state.undefined);
        snapshot.require(state.own[0].front() <= std::max<Tick>(0, state.keep) &&
                         state.own[1].front() <= std::max<Tick>(0, state.keep));
    }
    for (Registers& registers : inputs_) {
        registers[0].transfer(snapshot);
        registers[1].transfer(snapshot);
    }
    snapshot.item(seen_);
    snapshot.require(seen_ >= -1 && seen_ < forever);
    if (!snapshot.loading()) return;
    seen_before_ = seen_;
    for (Totals& totals : totals_)
        totals.forget();
    clear();
}

} // namespace rtamt::early
