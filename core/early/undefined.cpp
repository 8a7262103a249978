// Operations without a value. They are an error at a tick that the trace has reached, or that is
// read when it ends, where their operands are known exactly or will not be known better; until then
// nothing is known of the value. What has none for some bounds has none for narrower ones either.
#include "bounds_engine.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace rtamt::early {

bool BoundsEngine::is_error(std::uint32_t index, Tick t, bool exact) const noexcept {
    return reached(index, t) &&
           (exact || plus(t, std::max<Tick>(0, node(index).horizon)) <= complete_);
}

// The first step, and of that the earliest tick.
std::optional<BoundsEngine::Failure> BoundsEngine::fails(std::uint32_t index) const noexcept {
    const State& state = nodes_[index];
    const auto& [exact, any, step] = state.undefined; // `any` is not later than `exact`
    std::pair found(state.wrong, state.wrong_at);
    if (is_error(index, any, false)) {
        found = std::min(found, std::pair(step, any));
    } else if (is_error(index, exact, true)) {
        found = std::min(found, std::pair(step, exact));
    }
    if (found.first == none) return std::nullopt;
    return Failure{index, found.first, found.second};
}

// Notes a step without a value, which fails() finds where that is an error.
void BoundsEngine::has_no_value(std::uint32_t index, std::uint32_t step, Tick t,
                                bool exact) noexcept {
    State& state = nodes_[index];
    auto& undefined = state.undefined;
    if (exact) undefined.exact = std::min(undefined.exact, t);
    undefined.any = std::min(undefined.any, t);
    undefined.step = step;
    awaited_ = true;
    if (!is_error(index, t, exact)) return;
    std::tie(state.wrong, state.wrong_at) =
        std::min(std::pair(state.wrong, state.wrong_at), std::pair(step, t));
}

std::optional<BoundsEngine::Failure> BoundsEngine::close_inputs(Tick tick) noexcept {
    settle_inputs(tick);
    for (std::uint32_t i = 0; awaited_ && i < nodes_.size(); ++i) {
        if (const auto failure = fails(i)) {
            complete_ = complete_before_;
            return failure;
        }
    }
    return std::nullopt;
}

// How far behind the newest sample each node is read when the trace ends, after which every input
// holds its last value. `forever`: nodes that something else reads so far. The recursion of until
// ends where the window does that is above it.
void BoundsEngine::find_beyond(std::span<const std::uint32_t> read_forever) {
    std::vector<Tick> within(nodes_.size(), -1); // the last tick of such a window
    for (State& state : nodes_)
        state.beyond = 0;
    for (const std::uint32_t ref : read_forever)
        nodes_[ref / 2].beyond = forever;
    for (std::size_t i = nodes_.size(); i-- > 0;) {
        const Node& own = node(i);
        if (own.kind == Kind::atom) continue;
        const Tick beyond = nodes_[i].beyond;
        Tick read = plus(beyond, std::max<Tick>(0, own.high));
        if (own.horizon < forever) {
            within[i] = plus(beyond, own.horizon);
        } else if (within[i] < 0) {
            within[i] = forever;
        }
        if (own.kind == Kind::until) {
            read = plus(within[i], -std::max(horizon(own.a), horizon(own.b)));
        }
        for (const std::uint32_t ref : {own.a, own.b}) {
            if (ref == none) continue;
            Tick& below = nodes_[ref / 2].beyond;
            below = std::max(below, read);
            within[ref / 2] = std::max(within[ref / 2], within[i]);
        }
    }
}

} // namespace rtamt::early
