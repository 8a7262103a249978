// Programs whose meaning over one value domain follows from that over reals.
#pragma once

#include "discrete/oracle.hpp"
#include "program/number_functions.hpp"
#include "programs.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace programs {

// A program with two registers, lower and upper, for each register of an interval program: inputs
// 2k and 2k + 1 are the bounds of input k. Negation swaps them.
inline Program corners(const Program& program) {
    Program twice;
    twice.inputs = 2 * program.inputs;
    for (const Instruction& instruction : program.instructions) {
        const bool swaps_a = instruction.opcode == Opcode::neg;
        const bool swaps_b = instruction.opcode == Opcode::sub ||
                             instruction.opcode == Opcode::holds_gt ||
                             instruction.opcode == Opcode::holds_ge;
        for (const std::uint32_t upper : {0U, 1U}) {
            Instruction bound = instruction;
            const auto of = [&](std::uint32_t operand, bool swaps) {
                return operand == rtamt::no_operand ? rtamt::no_operand
                                                    : 2 * operand + (swaps ? 1 - upper : upper);
            };
            bound.a = of(instruction.a, swaps_a);
            bound.b = of(instruction.b, swaps_b);
            if (instruction.opcode == Opcode::input) bound.n = 2 * instruction.n + upper;
            twice.instructions.push_back(bound);
        }
    }
    for (const std::uint32_t output : program.outputs) {
        twice.outputs.push_back(2 * output);
        twice.outputs.push_back(2 * output + 1);
    }
    return twice;
}

// Whether every operation has its extrema at corners that depend on the operation alone.
inline bool monotone(const Program& program) {
    return std::ranges::none_of(program.instructions, [](const Instruction& instruction) {
        switch (instruction.opcode) {
        case Opcode::add:
        case Opcode::sub:
            return false;
        case Opcode::holds_eq:
            return true;
        default:
            return rtamt::with_function(
                instruction.opcode, [](auto) { return true; }, [] { return false; });
        }
    });
}

// Predicates of arithmetic that is never undefined nor zero, connectives and temporal operators
// over them; here and there a formula as a number, a number as a formula, an input as a formula.
inline Program truth_program(oracle::Random& random, int size) {
    Builder builder;
    std::vector<std::uint32_t> numbers{builder.input()};
    std::vector<std::uint32_t> formulas{builder.input(), builder.constant(oracle::inf)};
    const auto of = [&](const std::vector<std::uint32_t>& all) {
        return all[static_cast<std::size_t>(
            random.between(0, static_cast<std::int64_t>(all.size()) - 1))];
    };
    const auto constant = [&](std::uint32_t a) {
        return builder.program().instructions[a].opcode == Opcode::constant;
    };
    const auto align = [&](std::uint32_t& a, std::uint32_t& b) {
        if (constant(a) || constant(b)) return;
        const std::int64_t apart = builder.lag(a) - builder.lag(b);
        if (apart > 0) b = builder.later(b, apart);
        if (apart < 0) a = builder.later(a, -apart);
    };
    for (int i = 0; i < size; ++i) {
        const double offset = static_cast<double>(random.between(-9, 9)) + 0.125;
        std::uint32_t a = of(numbers);
        std::uint32_t p = of(formulas);
        std::uint32_t q = of(formulas);
        const std::int64_t width = random.between(1, 20);
        switch (random.between(0, 9)) {
        case 0: { // a number over time
            const std::int64_t lag = builder.lag(a) + random.between(0, width);
            numbers.push_back(builder.unary(Opcode::slide_max, a, width, lag));
            break;
        }
        case 1:
            numbers.push_back(builder.pointwise(Opcode::abs, a));
            break;
        case 2: // a predicate, or a number used as a formula
            formulas.push_back(builder.pointwise(random.chance(50) ? Opcode::holds_ge : Opcode::sub,
                                                 a, builder.constant(offset)));
            break;
        case 3: // a formula used as a number
            formulas.push_back(builder.pointwise(
                Opcode::holds_gt, builder.pointwise(Opcode::abs, p), builder.constant(offset)));
            break;
        case 4:
            formulas.push_back(builder.pointwise(Opcode::neg, p));
            break;
        case 5:
            align(p, q);
            formulas.push_back(
                builder.pointwise(random.chance(50) ? Opcode::min : Opcode::max, p, q));
            break;
        case 6:
        case 7: {
            const auto opcode = random.chance(50) ? Opcode::slide_max : Opcode::slide_min;
            formulas.push_back(
                builder.unary(opcode, p, width, builder.lag(p) + random.between(0, width)));
            break;
        }
        case 8:
            formulas.push_back(builder.unary(random.chance(50) ? Opcode::run_max : Opcode::run_min,
                                             p, 0, builder.lag(p)));
            break;
        default: {
            align(p, q);
            const std::int64_t lag = std::max(builder.lag(p), builder.lag(q));
            formulas.push_back(random.chance(50)
                                   ? builder.binary(Opcode::since, p, q, 0, lag)
                                   : builder.binary(Opcode::until, p, q, width, lag + width - 1));
            break;
        }
        }
    }
    builder.output(formulas.back()).output(of(formulas));
    return builder.program();
}

} // namespace programs
