// Operations without a value: an error where the trace has come so far, nothing known until then.
#include "engine.hpp"

#include <algorithm>

namespace rtamt::early {

std::optional<Engine::Failure> Engine::fails(std::uint32_t index, Tick t) noexcept {
    if (reached(index, t)) return Failure{index, 0, t};
    nodes_[index].undefined = std::min(nodes_[index].undefined, t);
    return std::nullopt;
}

// How far behind the newest sample each node is read when the trace ends, after which every input
// holds its last value. `forever`: nodes that something else reads so far. The recursion of until
// ends where the window does that is above it.
void Engine::find_beyond(std::span<const std::uint32_t> read_forever) {
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
