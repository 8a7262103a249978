// Operations without a value. They are an error at a tick that the trace has reached, or that is
// read when it ends, where their operands are known exactly or will not be known better; until then
// nothing is known of the value. What has none for some bounds has none for narrower ones either.
#include "bounds_engine.hpp"

#include <algorithm>

namespace rtamt::early {

std::optional<BoundsEngine::Failure> BoundsEngine::fails(std::uint32_t index) const noexcept {
    const auto& [exact, any, step] = nodes_[index].undefined;
    if (reached(index, exact)) return Failure{index, step, exact};
    const Tick horizon = std::max<Tick>(0, node(index).horizon);
    if (reached(index, any) && plus(any, horizon) <= complete_) return Failure{index, step, any};
    return std::nullopt;
}

std::optional<BoundsEngine::Failure> BoundsEngine::fails(std::uint32_t index, std::uint32_t step,
                                                         Tick t, bool exact) noexcept {
    auto& undefined = nodes_[index].undefined;
    if (exact) undefined.exact = std::min(undefined.exact, t);
    undefined.any = std::min(undefined.any, t);
    undefined.step = step;
    awaited_ = true;
    return fails(index);
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
