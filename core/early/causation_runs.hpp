// Runs of what the newest samples cause: in order, and without ticks at which they cause nothing.
#pragma once

#include "runs.hpp"

#include <vector>

namespace rtamt::early {

using Pieces = std::vector<Run>;

// Adds a run behind all others.
void append(Pieces& pieces, Tick begin, Tick end, double value);
// Adds the values of a register at the ticks of [l, r].
void append(Pieces& pieces, const Runs& own, Tick l, Tick r);

// Makes of runs in any order, which may overlap, their maximum.
void envelope(Pieces& pieces);

// The smaller value where both are.
[[nodiscard]] Pieces both(const Pieces& a, const Pieces& b);

// Cuts runs to [0, last].
void clip(Pieces& pieces, Tick last);

// Cuts values to those of a register.
void limit(Pieces& pieces, const Runs& own);

// Adds the runs of a window [t + low, t + high], in any order.
void widen(Pieces& pieces, const Pieces& operand, Tick low, Tick high);

[[nodiscard]] Pieces shifted(Pieces pieces, Tick by);
// The same in reversed time.
[[nodiscard]] Pieces reversed(const Pieces& pieces);

[[nodiscard]] double value_at(const Pieces& pieces, Tick t) noexcept;
// The greatest value from a tick on.
[[nodiscard]] double most(const Pieces& pieces, Tick from) noexcept;

} // namespace rtamt::early
