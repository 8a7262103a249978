// The factory of kernels: creates the kernel of an instruction.
#pragma once

#include "../program/program.hpp"
#include "../values/domain.hpp"
#include "kernel.hpp"

#include <memory>

namespace rtamt::dense {

// Makes the kernels of a program whose formulas have values of a domain.
template <ValueDomain D>
struct Kernels {
    // Null for inputs and constants: a constant is an event where its reader's operands begin, and
    // so a separate kernel for each such lag. `sort` is that of the instruction's value.
    [[nodiscard]] static std::unique_ptr<Kernel> make(const Instruction& instruction, Sort sort);

    [[nodiscard]] static std::unique_ptr<Kernel> constant(Sort sort, std::int64_t lag, double x);

    // The kernel that makes a value of one sort one of the other.
    [[nodiscard]] static std::unique_ptr<Kernel> cross(Sort from, std::int64_t lag)
        requires(!UniformDomain<D>);
};

} // namespace rtamt::dense
