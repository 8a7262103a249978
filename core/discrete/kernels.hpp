// From an instruction to its kernel, and to the memory that the kernel needs.
#pragma once

#include "../kernel.hpp"
#include "../program.hpp"
#include "pointwise.hpp"

#include <cstddef>
#include <memory>

namespace rtamt::discrete {

// Doubles of state in the arena.
[[nodiscard]] std::size_t state_size(const Instruction& instruction) noexcept;

// Null for inputs and constants, which compute nothing. `state` and `journal` point to state_size()
// doubles each; the journal is only used by checkpoint() and rollback(). `same`: which operands are
// constants.
[[nodiscard]] std::unique_ptr<Kernel> make_kernel(const Instruction& instruction,
                                                  std::int64_t operand_lag, double* state,
                                                  double* journal, Same same = {});

} // namespace rtamt::discrete
