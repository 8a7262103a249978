// From an instruction to its kernel.
#pragma once

#include "../program/program.hpp"
#include "kernel.hpp"

#include <memory>

namespace rtamt::fleet {

// Null for inputs, constants and calls.
[[nodiscard]] std::unique_ptr<Kernel> make_kernel_of(const Program& program,
                                                     const Instruction& instruction, Sort sort);

} // namespace rtamt::fleet
