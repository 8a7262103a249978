// The reports of one value in dense time: its verdicts, or the runs of its changed bounds.
//
// The engine counts ticks from the start of the trace; what is reported has the caller's.
#pragma once

#include "bound_changes.hpp"
#include "bounds_engine.hpp"
#include "eager_verdicts.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace rtamt::early {

class DenseOutput {
  public:
    // The value of a reference; `decides`: verdicts, if not, bounds.
    DenseOutput(std::uint32_t ref, bool decides, const BoundsEngine& engine);

    // The last change of the engine, which the caller dates `at`; the newest sample now and before,
    // -1 where the trace begins now.
    void collect(const BoundsEngine& engine, Tick start, Tick at, Tick before, Tick newest);

    // The same of a change that the engine does not know yet, where bounds are reported: of what it
    // changes, as much as settle() looks at.
    void expect(Tick before, Tick newest);

    // What the last call decided, or changed, in order.
    [[nodiscard]] const std::vector<Decision>& decisions() const noexcept { return decided_; }
    [[nodiscard]] std::vector<BoundChange> changes(const BoundsEngine& engine, Tick start) const;
    // All that is held, up to the newest sample.
    [[nodiscard]] std::vector<BoundChange> runs(const BoundsEngine& engine, Tick start,
                                                Tick newest) const;
    // None before the first tick that is held.
    [[nodiscard]] std::optional<Bounds> at(const BoundsEngine& engine, Tick t) const noexcept;
    // The first tick that is held. What is final is held for some more calls.
    [[nodiscard]] Tick held() const noexcept { return held_; }

    // Forgets what is final; returns the first tick that is still needed. `closed`: the last tick
    // whose samples have all arrived.
    [[nodiscard]] Tick settle(const BoundsEngine& engine, Tick closed) noexcept;

    [[nodiscard]] std::uint32_t ref() const noexcept { return ref_; }
    [[nodiscard]] std::size_t bytes() const noexcept { return decisions_.bytes(); }

    void transfer(Snapshot& snapshot);

  private:
    std::uint32_t ref_;
    bool decides_;
    EagerVerdicts decisions_;
    std::vector<Decision> decided_;
    BoundChanges changes_;
    Tick open_ = 0; // the first tick without a verdict
    Tick held_ = 0;
    Tick next_held_ = 0; // after the next call of settle()
};

// Runs in the caller's ticks, and as they are reported.
[[nodiscard]] std::vector<BoundChange> timed(std::vector<BoundChange> runs, Tick start);

} // namespace rtamt::early
