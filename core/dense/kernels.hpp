// From an instruction to its kernel.
#pragma once

#include "../program.hpp"
#include "kernel.hpp"

#include <memory>

namespace rtamt::dense {

// Null for inputs and constants: a constant is an event where its reader's operands begin, and so a
// kernel of its own for each such lag (constant.hpp).
[[nodiscard]] std::unique_ptr<Kernel> make_kernel(const Instruction& instruction);

} // namespace rtamt::dense
