// Causation: by how much the newest samples alone violate and satisfy a formula.
//
// Z. Zhang et al., "Online causation monitoring of signal temporal logic", CAV 2023. Two more
// registers beside those of the bounds: register 0 holds how good the newest samples make a part at
// a tick, register 1 how bad, negated, so that negation exchanges them and one set of rules serves
// both. What an atom causes is its value at the ticks that they make known and -inf elsewhere,
// nothing; a function of several ticks causes its bounds where they have moved. What takes the
// greatest of its operands takes the greatest of what they cause; what takes the least takes the
// greatest too, but not more than its own bound.
//
// Nothing is kept from one sample to the next. Cost: proportional to the runs of what is caused,
// and for until to those of its operands as far as it reaches.
#pragma once

#include "bound_changes.hpp"
#include "bounds_at_start.hpp"
#include "bounds_engine.hpp"
#include "causation_runs.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace rtamt::early {

// A part of a formula, operands first. A reference to a part is twice its index, plus one where it
// is negated.
struct Cause {
    enum class Kind : std::uint8_t { atom, span, both, either, least, greatest, until, since };
    Kind kind{};
    std::uint32_t ref = none; // of the graph, whose bounds are those of this part
    std::uint32_t a = none;   // references to parts
    std::uint32_t b = none;
    Tick low = 0; // the window; of until and since the bounds of b
    Tick high = 0;
    Tick shift = 0;            // of until: it is read from so much earlier
    std::uint32_t core = none; // of the graph: the recursion of until or since
};

// An item of the formula at the start of the trace: of value, all and some the part, of until both
// operands. `before` and `rest`: the items of a window [0, a) over hold and of the recursion from
// there, if the item is their conjunction.
struct StartingCause {
    std::uint32_t a = none;
    std::uint32_t b = none;
    std::uint32_t before = none;
    std::uint32_t rest = none;
};

// The ticks at which something is caused, up to a tick, in order; the violation is negated.
[[nodiscard]] std::vector<BoundChange> caused_runs(const Pieces& satisfaction,
                                                   const Pieces& violation, Tick last);

struct CauseGraph {
    std::vector<Cause> parts;
    std::vector<std::uint32_t> outputs;
    std::vector<StartingCause> starts; // of the items at the start
};

class Causes {
  public:
    Causes(CauseGraph graph, const BoundsEngine& engine, const BoundsAtStart& at_start, bool dense);

    // Looks at the newest sample in discrete time, or at what has become known in dense time. The
    // engine and the items at the start know it.
    void read(const BoundsEngine& engine, const BoundsAtStart& at_start, Tick newest);
    void read(const BoundsEngine& engine, const BoundsAtStart& at_start,
              std::span<const BoundsEngine::Observation> observations);

    // Asks for what is read of operands beside what the engine itself reads; `wanted`: by node.
    void settle(const BoundsEngine& engine, Tick closed, std::span<Tick> wanted) const noexcept;

    // Violation is the upper end, satisfaction the lower.
    [[nodiscard]] Bounds at(std::size_t output, Tick t) const noexcept;
    [[nodiscard]] Bounds at_start() const noexcept { return start_; }

    // The ticks at which something is caused, up to a tick, in order.
    [[nodiscard]] std::vector<BoundChange> runs(std::size_t output, Tick last) const;

    void transfer(Snapshot& snapshot);

  private:
    using Part = std::array<Pieces, 2>;

    // What has become known: at the newest tick, or by observations.
    struct NewData {
        Tick newest = 0;
        std::span<const BoundsEngine::Observation> observations;
    };

    std::vector<Cause> causes_;
    std::vector<std::uint32_t> outputs_;
    std::vector<StartingCause> starts_;
    bool dense_;
    Tick reach_ = 0; // farther from the newest sample than anything is read that still changes
    std::vector<Part> parts_;
    std::vector<Part> known_; // by output
    std::vector<std::array<double, 2>> items_;
    Bounds start_{-infinity, infinity};

    [[nodiscard]] const Pieces& of(std::uint32_t ref, int reg) const noexcept {
        return parts_[ref / 2][static_cast<std::size_t>(reg) ^ (ref & 1U)];
    }
    void check(const BoundsEngine& engine, const BoundsAtStart& at_start);
    [[nodiscard]] Tick last(const NewData& new_data) const noexcept;
    void read(const BoundsEngine& engine, const BoundsAtStart& at_start, const NewData& new_data);
    void compute(const BoundsEngine& engine, std::size_t index, int reg, const NewData& new_data);
    // Of until and since, register 0 and 1.
    [[nodiscard]] Pieces together(const BoundsEngine& engine, const Cause& cause, Tick last) const;
    [[nodiscard]] Pieces apart(const Cause& cause) const;
    [[nodiscard]] double item(const BoundsEngine& engine, const BoundsAtStart& at_start,
                              std::size_t index, int reg) const noexcept;
    [[nodiscard]] double until_item(const BoundsEngine& engine, const BoundsAtStart& at_start,
                                    std::size_t index) const noexcept;
};

} // namespace rtamt::early
