// A step function of three truth values: what is decided of a node at every tick.
//
// A value is decided once, so that what is filled with it was open, or had it already: a fill
// leaves one run behind.
//
// Cost of a fill: a search, and amortised constant time, since every run that it passes over joins
// the one that it leaves. Memory: the runs.
#pragma once

#include "step_map.hpp"

#include <cstdint>
#include <vector>

namespace rtamt::early {

// Bit 0 is set where it holds, bit 1 where it does not, so that the connectives are those of bits.
enum class Kleene : std::uint8_t { open = 0, holds = 1, fails = 2 };

[[nodiscard]] constexpr Kleene flipped(Kleene a) noexcept {
    const auto bits = static_cast<unsigned>(a);
    return static_cast<Kleene>((bits & 1U) << 1U | bits >> 1U);
}

[[nodiscard]] constexpr Kleene both(Kleene a, Kleene b) noexcept {
    const auto x = static_cast<unsigned>(a);
    const auto y = static_cast<unsigned>(b);
    return static_cast<Kleene>((x & y & 1U) | ((x | y) & 2U));
}

[[nodiscard]] constexpr Kleene either(Kleene a, Kleene b) noexcept {
    const auto x = static_cast<unsigned>(a);
    const auto y = static_cast<unsigned>(b);
    return static_cast<Kleene>(((x | y) & 1U) | (x & y & 2U));
}

// Ticks [l, r] that became decided.
struct Decided {
    Tick l;
    Tick r;
    Kleene value;
};

class KleeneRuns : public StepMap<Kleene> {
  public:
    // Open for ever.
    KleeneRuns() : StepMap(0, Kleene::open) {}

    // Decides what is open in [l, r], and adds it to what was decided, in order.
    void fill(Tick l, Tick r, Kleene value, std::vector<Decided>& decided);

  private:
    [[nodiscard]] bool splice(Tick l, Tick r, Kleene value, std::vector<Decided>& decided);
};

} // namespace rtamt::early
