// The factory of kernels: the kernel of an instruction, and the memory that it needs.
#pragma once

#include "../program/program.hpp"
#include "../values/domain.hpp"
#include "kernel.hpp"
#include "pointwise.hpp"

#include <cstddef>
#include <memory>

namespace rtamt::discrete {

// Makes the kernels of a program whose formulas have values of a domain.
template <ValueDomain D>
struct Kernels {
    // Bytes of state in the arena of an instruction whose value has this sort.
    [[nodiscard]] static std::size_t state_size(const Instruction& instruction, Sort sort) noexcept;

    // Null for inputs and constants, which compute nothing. `state` and `journal` point to
    // state_size() bytes each; the journal is only used by checkpoint() and rollback(). `same`:
    // which operands are constants.
    [[nodiscard]] static std::unique_ptr<Kernel> make(const Instruction& instruction, Sort sort,
                                                      std::int64_t operand_lag, void* state,
                                                      void* journal, Same same = {});

    // The kernel that copies a value of one sort to a register of the other.
    [[nodiscard]] static std::unique_ptr<Kernel> cross(Sort from, std::int64_t lag)
        requires(!UniformDomain<D>);
};

} // namespace rtamt::discrete
