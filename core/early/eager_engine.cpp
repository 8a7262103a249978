#include "eager_engine.hpp"

#include "state_checks.hpp"
#include "trace_end.hpp"

#include <algorithm>
#include <type_traits>

namespace rtamt::early {

namespace {

[[nodiscard]] Kleene kleene(double value) noexcept {
    return value > 0 ? Kleene::holds : Kleene::fails;
}

[[nodiscard]] Kleene kleene(const Bounds& value) noexcept {
    if (value.lower > 0) return Kleene::holds;
    return value.upper < 0 ? Kleene::fails : Kleene::open;
}

[[nodiscard]] bool is_recursion(const Node& node) noexcept {
    return node.kind == Kind::since || node.low <= -forever;
}

} // namespace

// ---- construction -------------------------------------------------------------------------------

std::optional<EagerEngine> EagerEngine::of(const Graph& graph, std::span<const Bounds> ranges) {
    graph.check();
    const std::vector<bool> truths = graph.truths();
    std::vector<Bounds> unseen(ranges.begin(), ranges.end());
    unseen.resize(graph.inputs, bounds::anything);
    EagerEngine engine(graph);
    for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
        const Node& own = graph.nodes[i];
        State& state = engine.states_[i];
        if (!truths[i]) return std::nullopt;
        switch (own.kind) {
        case Kind::atom: {
            const Wrong wrong = enclose(own.steps, unseen, engine.bounds_);
            if (wrong.any != none) return std::nullopt;
            const Kleene value = kleene(engine.bounds_[own.steps.size() - 1]);
            if (value != Kleene::open) engine.fill(state, 0, forever, value);
            break;
        }
        case Kind::least:
        case Kind::greatest:
            engine.decide_empty(own, state);
            break;
        case Kind::both:
        case Kind::either:
        case Kind::until:
        case Kind::since:
            break;
        default:
            return std::nullopt;
        }
    }
    engine.propagate();
    return engine;
}

EagerEngine::EagerEngine(const Graph& graph)
    : graph_(graph), states_(graph.nodes.size()), values_(graph.nodes.size()) {
    std::size_t steps = 0;
    for (std::uint32_t i = 0; i < graph_.nodes.size(); ++i) {
        steps = std::max(steps, node(i).steps.size());
        if (node(i).kind != Kind::atom) {
            inner_.push_back(i);
        } else if (const auto found = threshold(node(i), i)) {
            thresholds_.push_back(*found);
        } else {
            others_.push_back(i);
        }
    }
    exact_.resize(steps);
    bounds_.resize(steps);
}

std::optional<EagerEngine::Threshold> EagerEngine::threshold(const Node& node,
                                                             std::uint32_t index) {
    const auto& steps = node.steps;
    if (steps.size() < 3 || steps.size() > 4) return std::nullopt;
    const Opcode opcode = steps[2].opcode;
    const bool negated = steps.size() == 4;
    if (opcode != Opcode::holds_gt && opcode != Opcode::holds_ge) return std::nullopt;
    if (negated && (steps[3].opcode != Opcode::neg || steps[3].a != 2)) return std::nullopt;
    const std::uint32_t left = steps[2].a;
    const std::uint32_t right = steps[2].b;
    if (left + right != 1) return std::nullopt; // not the two steps before
    const bool less = steps[left].opcode == Opcode::constant;
    const Step& input = steps[less ? right : left];
    const Step& number = steps[less ? left : right];
    if (input.opcode != Opcode::input || number.opcode != Opcode::constant) return std::nullopt;
    return Threshold{number.x, index, input.a, opcode == Opcode::holds_gt, less, negated};
}

// At the start of the trace nothing is in a window of the past yet.
void EagerEngine::decide_empty(const Node& node, State& state) const {
    const Kleene empty = node.kind == Kind::least ? Kleene::holds : Kleene::fails;
    if (node.high < 0) fill(state, 0, -node.high - 1, empty);
}

// ---- samples ------------------------------------------------------------------------------------

// Every atom is computed before anything changes.
template <class Value>
std::optional<EagerEngine::Failure> EagerEngine::row(Tick t, std::span<const Value> values) {
    if constexpr (std::is_same_v<Value, double>) {
        for (const Threshold& each : thresholds_) {
            const double left = each.less ? each.number : values[each.input];
            const double right = each.less ? values[each.input] : each.number;
            const bool holds = each.strict ? left > right : left >= right;
            values_[each.node] = holds != each.negated ? Kleene::holds : Kleene::fails;
        }
        for (const std::uint32_t i : others_) {
            const std::uint32_t wrong = run<double>(node(i).steps, values, exact_);
            if (wrong != none) return Failure{i, wrong, t};
            values_[i] = kleene(exact_[node(i).steps.size() - 1]);
        }
    } else {
        for (std::uint32_t i = 0; i < states_.size(); ++i) {
            if (node(i).kind != Kind::atom) continue;
            const std::uint32_t wrong = run<Bounds>(node(i).steps, values, bounds_);
            if (wrong != none) return Failure{i, wrong, t};
            values_[i] = kleene(bounds_[node(i).steps.size() - 1]);
        }
    }
    for (State& state : states_)
        state.decided.clear();
    const auto append = [&](std::uint32_t i) {
        State& state = states_[i];
        if (values_[i] != Kleene::open) fill(state, t, t, values_[i]);
    };
    for (const Threshold& each : thresholds_)
        append(each.node);
    for (const std::uint32_t i : others_)
        append(i);
    propagate();
    return std::nullopt;
}

template std::optional<EagerEngine::Failure> EagerEngine::row(Tick, std::span<const double>);
template std::optional<EagerEngine::Failure> EagerEngine::row(Tick, std::span<const Bounds>);

void EagerEngine::fill(State& state, Tick l, Tick r, Kleene value) const {
    state.own.fill(std::max(l, state.from), r, value, state.decided);
}

// Lets every node look at what became decided of its operands.
void EagerEngine::propagate() {
    for (const std::uint32_t i : inner_) {
        const Node& own = node(i);
        State& state = states_[i];
        if (state.from >= forever) continue; // nothing reads it
        switch (own.kind) {
        case Kind::both:
        case Kind::either:
            combine(own, state);
            break;
        case Kind::least:
        case Kind::greatest:
            slide(own, state);
            break;
        default:
            const auto& first = decided(own.a);
            const auto& second = decided(own.b);
            const auto look = [&](const Decided& piece) {
                own.kind == Kind::until ? until(own, state, piece.l, piece.r)
                                        : since(own, state, piece.l, piece.r);
            };
            for (const Decided& piece : first)
                look(piece);
            for (std::size_t k = 0; k < second.size(); ++k) { // nearly always the same ticks
                const bool looked =
                    k < first.size() && first[k].l == second[k].l && first[k].r == second[k].r;
                if (!looked) look(second[k]);
            }
        }
    }
}

void EagerEngine::combine(const Node& node, State& state) const {
    const Kleene wins = node.kind == Kind::either ? Kleene::holds : Kleene::fails;
    for (const bool first : {true, false}) {
        const std::uint32_t ref = first ? node.a : node.b;
        const std::uint32_t other = first ? node.b : node.a;
        for (const Decided& piece : decided(ref)) {
            const Kleene value = through(ref, piece.value);
            if (value == wins) {
                fill(state, piece.l, piece.r, value);
                continue;
            }
            for (Tick t = std::max(piece.l, state.from); t <= piece.r;) {
                const DecidedRun run = at(other, t);
                if (run.value == value) fill(state, t, std::min(run.end, piece.r), value);
                if (run.end >= forever) break;
                t = run.end + 1;
            }
        }
    }
}

// One value decides all windows that it is in; the other one those that lie in its run.
void EagerEngine::slide(const Node& node, State& state) const {
    const Kleene wins = node.kind == Kind::greatest ? Kleene::holds : Kleene::fails;
    for (const Decided& piece : decided(node.a)) {
        const Kleene value = through(node.a, piece.value);
        Tick l = plus(piece.l, -node.high);
        Tick r = plus(piece.r, -node.low);
        if (value != wins) {
            const DecidedRun run = at(node.a, piece.l);
            const bool starts = run.begin <= 0; // where windows are cut
            r = std::min(r, plus(run.end, -node.high));
            if (node.low > -forever) {
                l = std::max(l, starts ? 0 : plus(run.begin, -node.low));
            } else {
                l = std::max(l, state.from);
                const bool goes_on = plus(l, node.high) <= 0 || state.own.at(l - 1).value == value;
                if (!goes_on) continue;
            }
        }
        fill(state, l, r, value);
    }
}

// ---- recursions ---------------------------------------------------------------------------------

// From the right: goal or (hold and next). Where hold and goal stay the same, so does the value.
void EagerEngine::until(const Node& node, State& state, Tick l, Tick r) const {
    Kleene next = r < forever ? state.own.at(r + 1).value : Kleene::fails;
    for (Tick t = r; t >= state.from;) {
        const DecidedRun hold = at(node.a, t);
        const DecidedRun goal = at(node.b, t);
        const DecidedRun mine = state.own.at(t);
        const Tick begin = std::min(t, std::max({hold.begin, goal.begin, mine.begin, state.from}));
        const Kleene now = either(goal.value, both(hold.value, next));
        const bool changes = mine.value == Kleene::open && now != Kleene::open;
        if (changes) {
            fill(state, begin, t, now);
        } else if (begin <= l) {
            return;
        }
        next = changes ? now : mine.value;
        t = begin - 1;
    }
}

// From the left: goal or (hold and before).
void EagerEngine::since(const Node& node, State& state, Tick l, Tick r) const {
    if (r < state.from) return;
    Tick t = std::max(l, state.from);
    Kleene before = t == 0 ? Kleene::fails : state.own.at(t - 1).value;
    for (;;) {
        const DecidedRun hold = at(node.a, t);
        const DecidedRun goal = at(node.b, t);
        const DecidedRun mine = state.own.at(t);
        const Tick end = std::min({hold.end, goal.end, mine.end});
        const Kleene now = either(goal.value, both(hold.value, before));
        const bool changes = mine.value == Kleene::open && now != Kleene::open;
        if (changes) {
            fill(state, t, end, now);
        } else if (end >= r) {
            return;
        }
        if (end >= forever) return;
        before = changes ? now : mine.value;
        t = end + 1;
    }
}

// ---- clean-up -----------------------------------------------------------------------------------

void EagerEngine::settle(Tick closed, std::span<const Tick> wanted) {
    std::vector<Tick> need(wanted.begin(), wanted.end());
    for (std::size_t i = states_.size(); i-- > 0;) {
        const Node& own = node(i);
        State& state = states_[i];
        const bool recursion = is_recursion(own);
        const Tick open = std::max<Tick>(0, plus(plus(closed, 1), -own.horizon));
        Tick from = recursion ? open : std::max(need[i], open);
        if (need[i] >= forever) from = forever;
        state.from = std::max(state.from, from);
        state.keep = std::max(state.keep, std::min(need[i], from) - (recursion ? 1 : 0));
        state.own.drop_before(state.keep);
        if (own.kind == Kind::atom) continue;
        const bool window = own.kind == Kind::least || own.kind == Kind::greatest;
        const Tick reach = own.low <= -forever ? own.high : own.low;
        for (const std::uint32_t ref : {own.a, own.b}) {
            if (ref == none) continue;
            Tick& below = need[ref / 2];
            below = std::min(below, std::max<Tick>(0, window ? plus(from, reach) : from));
        }
    }
}

Bounds EagerEngine::bounds(std::uint32_t ref, Tick t) const noexcept {
    switch (at(ref, t).value) {
    case Kleene::holds:
        return Interval::top;
    case Kleene::fails:
        return Interval::bottom;
    default:
        return bounds::anything;
    }
}

std::vector<BoundsEngine::Rest> EagerEngine::ended(std::span<const std::uint32_t> refs,
                                                   Tick end) const {
    std::vector<HeldNode> held;
    held.reserve(states_.size());
    for (const State& state : states_)
        held.push_back({state.keep, state.from});
    const auto value = [this](std::uint32_t ref, Tick t) { return bounds(ref, t); };
    return bounds_at_end(graph_, held, value, refs, end);
}

std::size_t EagerEngine::bytes() const noexcept {
    std::size_t sum = 0;
    for (const State& state : states_)
        sum += state.own.bytes();
    return sum;
}

void EagerEngine::transfer(Snapshot& snapshot) {
    for (State& state : states_) {
        state.own.transfer(snapshot);
        checked::tick_or_forever(snapshot, state.from);
        checked::tick_or_forever(snapshot, state.keep);
        snapshot.require(state.own.front() <= state.keep && state.keep <= state.from);
        state.decided.clear();
    }
}

} // namespace rtamt::early
