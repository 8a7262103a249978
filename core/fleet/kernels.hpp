// The factory of kernels: creates the kernel of an instruction.
#pragma once

#include "../program/program.hpp"
#include "kernel.hpp"

#include <memory>

namespace rtamt::fleet {

// Null for inputs, constants and calls.
[[nodiscard]] std::unique_ptr<Kernel> make_kernel_of(const Program& program,
                                                     const Instruction& instruction, Sort sort);

} // namespace rtamt::fleet
