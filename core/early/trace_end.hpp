// Bounds at the end of a trace: the expected samples do not arrive, so windows are cut there. That
// may widen bounds, so they are recomputed, tick by tick, wherever they were not final.
#pragma once

#include "bounds_engine.hpp"

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace rtamt::early {

// What an engine still holds of a node.
struct HeldNode {
    Tick keep;                // the first tick
    Tick from;                // the first one that may not be final
    Tick undefined = forever; // the first one without a value, and by which step
    std::uint32_t step = 0;
};

// The bounds of references when the trace ends just before `end`; `at`: the bounds of a reference
// at a tick that is held. `failure`: what has no value then.
[[nodiscard]] std::vector<BoundsEngine::Rest>
bounds_at_end(const Graph& graph, std::span<const HeldNode> held,
              const std::function<Bounds(std::uint32_t, Tick)>& at,
              std::span<const std::uint32_t> refs, Tick end,
              std::optional<BoundsEngine::Failure>* failure = nullptr);

} // namespace rtamt::early
