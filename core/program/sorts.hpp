// The sort of each instruction of a program: number or formula.
//
// An instruction that works on either gives what its readers take: a formula, unless one of them
// takes a number. So a value crosses from one sort to the other in a predicate, or as late as it
// can. Outputs are formulas; an input that is read as a number anywhere is one.
//
// Cost: one pass over the program. Memory: a byte an instruction.
#pragma once

#include "program.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace rtamt {

// The sort of the operands of an instruction whose value has this sort.
[[nodiscard]] constexpr Sort taken(const Instruction& instruction, Sort given) noexcept {
    const Sort takes = info(instruction.opcode).takes;
    return takes == Sort::either ? given : takes;
}

// By instruction, the sort of its value.
[[nodiscard]] inline std::vector<Sort> sorts(const Program& program) {
    std::vector<Sort> sorts(program.instructions.size(), Sort::formula);
    for (std::size_t i = sorts.size(); i-- > 0;) {
        const Instruction& instruction = program.instructions[i];
        const OpcodeInfo& opcode = info(instruction.opcode);
        if (opcode.gives != Sort::either) sorts[i] = opcode.gives;
        if (taken(instruction, sorts[i]) != Sort::number) continue;
        program.each_operand(instruction, [&](std::uint32_t operand) {
            sorts[operand] = Sort::number; // kept by those that work on either
        });
    }
    std::vector<bool> number(program.inputs, false);
    const auto each_input = [&](auto&& visit) {
        for (std::size_t i = 0; i < sorts.size(); ++i) {
            const Instruction& instruction = program.instructions[i];
            if (instruction.opcode != Opcode::input) continue;
            visit(sorts[i], static_cast<std::size_t>(instruction.n));
        }
    };
    each_input([&](Sort sort, std::size_t n) { number[n] = number[n] || sort == Sort::number; });
    each_input([&](Sort& sort, std::size_t n) { sort = number[n] ? Sort::number : sort; });
    return sorts;
}

} // namespace rtamt
