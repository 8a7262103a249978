// The pass that reuses registers: values of which none is needed while the other is share one.
//
// Units run in the order of rollback_plan.hpp, the guarded ones first. A value lives from the unit
// that computes it, inputs from the start, to the last one that reads it. Outputs share no
// register: they are there after an update, and a failed one leaves them. A constant needs no
// register where each unit that reads it knows it for one.
//
// Cost: a sort of the values. Memory: a few words an instruction.
#pragma once

#include "fusion.hpp"
#include "program.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace rtamt {

inline constexpr std::uint32_t no_register = std::numeric_limits<std::uint32_t>::max();

// By instruction, its register, if it has one; and how many there are.
struct Registers {
    std::vector<std::uint32_t> rows;
    std::uint32_t count = 0;
};

namespace detail {

// The units between which a value lives, counted from 1 in the order in which they run.
struct Lifetime {
    std::uint32_t instruction;
    std::uint32_t first;
    std::uint32_t last;
};

// By instruction, the unit that computes it: 0 for inputs and constants.
[[nodiscard]] inline std::vector<std::uint32_t> units_of(const Program& program,
                                                         const Fusion& fusion) {
    std::vector<std::uint32_t> units(program.instructions.size(), 0);
    std::uint32_t next = 1;
    for (const bool guarded : {true, false}) {
        for (std::uint32_t i = 0; i < units.size(); ++i) {
            const Opcode opcode = program.instructions[i].opcode;
            if (opcode == Opcode::input || opcode == Opcode::constant) continue;
            if (fusion.guarded[i] == guarded && !fusion.inside(i)) units[i] = next++;
        }
    }
    for (std::uint32_t i = 0; i < units.size(); ++i)
        units[i] = units[fusion.roots[i]];
    return units;
}

// Whether the unit of an instruction reads a constant operand at each slot.
[[nodiscard]] inline bool reads_slots(const Program& program, const Fusion& fusion,
                                      std::uint32_t reader, std::uint32_t constant) {
    if (fusion.chained[reader]) return false;
    const Instruction& instruction = program.instructions[reader];
    const bool binary = info(instruction.opcode).pointwise && instruction.b != no_operand;
    return !binary || (constant == instruction.a && program.is_constant(instruction.b));
}

// Values that need a register, inputs first.
[[nodiscard]] inline std::vector<Lifetime> lifetimes(const Program& program, const Fusion& fusion) {
    constexpr std::uint32_t forever = std::numeric_limits<std::uint32_t>::max();
    const std::vector<std::uint32_t> units = units_of(program, fusion);
    std::vector<std::uint32_t> last(units);
    std::vector<bool> needed(units.size());
    for (std::uint32_t i = 0; i < units.size(); ++i) {
        needed[i] = !fusion.inside(i) && !program.is_constant(i);
        program.each_operand(program.instructions[i], [&](std::uint32_t operand) {
            last[operand] = std::max(last[operand], units[i]);
            if (program.is_constant(operand) && reads_slots(program, fusion, i, operand)) {
                needed[operand] = true;
                last[operand] = forever;
            }
        });
    }
    std::vector<std::uint32_t> first(units);
    for (const std::uint32_t output : program.outputs) {
        needed[output] = true;
        first[output] = 0;
        last[output] = forever;
    }
    std::vector<Lifetime> lifetimes;
    for (std::uint32_t i = 0; i < units.size(); ++i) {
        if (needed[i]) lifetimes.push_back({i, first[i], last[i]});
    }
    const auto place = [](const Lifetime& each) { return std::pair(each.first, each.instruction); };
    std::ranges::sort(lifetimes, {}, place);
    return lifetimes;
}

} // namespace detail

// The registers of a program, one for each value if it leaves the pass out.
[[nodiscard]] inline Registers registers(const Program& program, const Fusion& fusion) {
    const bool reuse = program.applies(Pass::reuse);
    Registers registers{std::vector<std::uint32_t>(program.instructions.size(), no_register), 0};
    const auto later = [](const auto& a, const auto& b) { return a.last > b.last; };
    std::vector<detail::Lifetime> living; // a heap with the first to end at its front
    for (const detail::Lifetime& value : detail::lifetimes(program, fusion)) {
        std::uint32_t& row = registers.rows[value.instruction];
        if (reuse && !living.empty() && living.front().last < value.first) {
            row = registers.rows[living.front().instruction];
            std::ranges::pop_heap(living, later);
            living.back() = value;
        } else {
            row = registers.count++;
            living.push_back(value);
        }
        std::ranges::push_heap(living, later);
    }
    return registers;
}

} // namespace rtamt
