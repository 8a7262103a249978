#include "bounds_engine.hpp"

#include "state_checks.hpp"

#include <algorithm>
#include <cmath>
#include <ranges>
#include <utility>

namespace rtamt::early {

namespace {

// Whether a step may have no value: a sum with a finite constant always has one.
[[nodiscard]] bool is_partial(const Node& node, const Step& step) noexcept {
    const auto finite = [&](std::uint32_t place) {
        return node.kind == Kind::atom && node.steps[place].opcode == Opcode::constant &&
               std::isfinite(node.steps[place].x);
    };
    if (step.opcode == Opcode::add || step.opcode == Opcode::sub) {
        return !finite(step.a) && !finite(step.b);
    }
    return info(step.opcode).partial;
}

} // namespace

BoundsEngine::BoundsEngine(Graph graph, std::vector<Bounds> ranges, Arrival arrival)
    : graph_(std::move(graph)), ranges_(std::move(ranges)), nodes_(graph_.nodes.size()),
      readers_(graph_.inputs), results_(graph_.nodes.size()), numbers_(graph_.inputs),
      row_(graph_.inputs) {
    graph_.check();
    truths_ = graph_.truths();
    ranges_.resize(graph_.inputs, bounds::anything);
    std::size_t steps = 0;
    for (std::uint32_t i = 0; i < graph_.nodes.size(); ++i) {
        steps = std::max(steps, node(i).steps.size());
        sums_.emplace_back(plus(node(i).high, plus(-node(i).low, 1)));
        if (node(i).kind == Kind::atom) atoms_.push_back(i);
        fallible_ = fallible_ || may_fail(node(i));
        for (const Step& step : node(i).steps) {
            partial_ = partial_ || is_partial(node(i), step);
            if (node(i).kind != Kind::atom || step.opcode != Opcode::input) continue;
            auto& readers = readers_[step.a];
            if (readers.empty() || readers.back() != i) readers.push_back(i);
        }
    }
    exact_.resize(steps);
    bounds_.resize(steps);
    if (arrival == Arrival::pieces) {
        for (const Bounds& range : ranges_)
            inputs_.emplace_back(0, range);
    }
    find_beyond({});
    (void)propagate(true); // what has no value before its sample is not known
    clear();
}

Bounds BoundsEngine::known(std::uint32_t input, Tick t) const noexcept {
    return inputs_[input].at(t).value;
}

Bounds BoundsEngine::at(std::uint32_t ref, Tick t) const noexcept {
    return {runs(ref, 0).at(t).value, -runs(ref, 1).at(t).value};
}

Tick BoundsEngine::reach() const noexcept {
    Tick sum = 0;
    for (const Node& node : graph_.nodes) {
        for (const Tick bound : {node.low, node.high}) {
            if (bound > -forever && bound < forever) sum = plus(sum, bound < 0 ? -bound : bound);
        }
    }
    return sum;
}

// A change, with samples up to a tick.
void BoundsEngine::begin(Tick newest) noexcept {
    change_ = 1 - change_;
    clear();
    seen_before_ = seen_;
    seen_ = std::max(seen_, newest);
    summed_ = seen_;
    if (!awaited_) return;
    for (State& state : nodes_)
        state.undefined_before = state.undefined;
}

void BoundsEngine::clear() noexcept {
    for (State& state : nodes_) {
        state.out[change_][0].clear();
        state.out[change_][1].clear();
    }
    journal_.clear();
    input_journal_.clear();
}

// Takes everything back if something failed.
std::optional<BoundsEngine::Failure> BoundsEngine::attempt(std::optional<Failure> failure) {
    if (failure) revert();
    return failure;
}

void BoundsEngine::revert() {
    for (const Undo& undo : std::views::reverse(journal_))
        undo.runs->set(undo.l, undo.r, undo.old);
    for (const auto& [input, before] : std::views::reverse(input_journal_))
        inputs_[input].set(before.begin, before.end, before.value);
    for (WindowSums& sums : sums_)
        sums.forget();
    for (State& state : nodes_) {
        state.undefined = state.undefined_before;
        state.wrong = none;
        state.wrong_at = forever;
    }
    seen_ = seen_before_;
    summed_ = seen_;
    complete_ = complete_before_;
    ended_ = false;
    clear();
    change_ = 1 - change_;
}

// ---- clean-up
// -----------------------------------------------------------------

// An operation that may have no value is followed wherever it is, needed or not: whether a sample
// is an error must not depend on what is already decided. Atoms of rows are computed when these
// come, followed or not.
bool BoundsEngine::may_fail(const Node& node) const noexcept {
    const auto partial = [&](const Step& step) { return is_partial(node, step); };
    return (node.kind == Kind::map || node.kind == Kind::sum ||
            (node.kind == Kind::atom && !inputs_.empty())) &&
           std::ranges::any_of(node.steps, partial);
}

void BoundsEngine::limit(std::span<const Tick> last) {
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

void BoundsEngine::settle(Tick closed, std::span<const Tick> wanted) {
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
    for (std::size_t i = 0; i < inputs_.size(); ++i) {
        inputs_[i].drop_before(std::min(input[i], plus(closed, 1)));
    }
}

std::size_t BoundsEngine::bytes() const noexcept {
    std::size_t sum = 0;
    for (const State& state : nodes_)
        sum += state.own[0].bytes() + state.own[1].bytes() + state.values.bytes();
    for (const auto& known : inputs_)
        sum += known.bytes();
    return sum;
}

void BoundsEngine::transfer(Snapshot& snapshot) {
    for (State& state : nodes_) {
        state.own[0].transfer(snapshot);
        state.own[1].transfer(snapshot);
        checked::tick_or_forever(snapshot, state.from);
        checked::tick_or_forever(snapshot, state.keep);
        checked::tick_or_forever(snapshot, state.undefined.exact);
        checked::tick_or_forever(snapshot, state.undefined.any);
        snapshot.item(state.undefined.step);
        const auto& steps = node(static_cast<std::size_t>(&state - nodes_.data())).steps;
        snapshot.require(state.undefined.step < std::max<std::size_t>(1, steps.size()));
        snapshot.require(state.own[0].front() <= state.keep && state.own[1].front() <= state.keep);
    }
    for (auto& known : inputs_)
        known.transfer(snapshot);
    checked::tick(snapshot, seen_, -1);
    checked::tick_or_forever(snapshot, complete_, -1);
    if (!snapshot.loading()) return;
    seen_before_ = seen_;
    complete_before_ = complete_;
    awaited_ = partial_;
    for (WindowSums& sums : sums_)
        sums.forget();
    for (State& state : nodes_) {
        state.slid = unread;
        state.wait = 0;
    }
    clear();
}

} // namespace rtamt::early
