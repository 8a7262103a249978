// Causation of until by the newest samples, hold until a goal within [t + low, t + high], where
// they make its operands good: a goal, or an instant of hold before one. What else must hold is as
// good as its lower bound.
//
// In discrete time hold is required on [t, goal). In dense time ticks are intervals: hold may be
// required until within the tick of the goal, and is from low > 0 on until within the first one;
// of since, which is until in reversed time, all of the goal's tick except the present is left.
//
// Cost: proportional to the pieces of the operands, and to the runs of the registers and of the
// result where pieces reach.
#pragma once

#include "causation_runs.hpp"

#include <cstdint>

namespace rtamt::early {

// The register of a node, perhaps in reversed time.
class View {
  public:
    View() = default;
    View(const Runs& runs, bool reversed) noexcept : runs_(&runs), reversed_(reversed) {}

    // The run in which a tick lies; before the start everything is held.
    [[nodiscard]] Run at(Tick t) const noexcept;
    [[nodiscard]] double least(Tick l, Tick r) const noexcept;
    [[nodiscard]] double most(Tick l, Tick r) const noexcept;

    // The last tick in [l, r] with a value that compares so, l - 1 if there is none; the first, or
    // r + 1.
    template <class Search>
    [[nodiscard]] Tick last(Tick l, Tick r, double value) const noexcept;
    template <class Search>
    [[nodiscard]] Tick first(Tick l, Tick r, double value) const noexcept;

  private:
    const Runs* runs_ = nullptr;
    bool reversed_ = false;

    bool turn(Tick& l, Tick& r) const noexcept;
};

struct CausedUntil {
    enum class Kind : std::uint8_t { discrete, dense, dense_since };

    Kind kind{};
    View hold;
    View goal;
    View core; // the recursion without bounds
    View own;  // of the operator as a whole
    Tick low = 0;
    Tick high = 0;
    Tick first = 0; // the ticks that are required
    Tick last = 0;
    Tick shift = 0; // `own` at t is that at t + shift

    // In any order, and they may overlap. Pieces of the operands are in order.
    [[nodiscard]] Pieces operator()(const Pieces& held, const Pieces& reached) const;

  private:
    [[nodiscard]] Pieces untimed(const Pieces& reached, Tick from) const;
    [[nodiscard]] Pieces by_goal(const Pieces& reached) const;
    [[nodiscard]] double best_goal(Tick from, Tick t) const noexcept;
    void near(Pieces& pieces, const Run& run) const;
    void far(Pieces& pieces, const Pieces& held) const;
    [[nodiscard]] Tick step() const noexcept { return kind == Kind::discrete ? 1 : 0; }
};

} // namespace rtamt::early
