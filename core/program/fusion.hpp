// The pass that fuses: which instructions are computed together, in one loop without registers for
// what lies between them.
//
// A chain is an instruction, its root, and all those that are read within the chain alone. Only the
// root has a register. Operands of a chain lie before its members, so that it runs in the place of
// its root. Where a member can fail, the whole chain does: it joins the guarded group
// (rollback_plan.hpp), with whatever it is computed from, as long as that needs no state.
//
// Cost: two passes over the program. Memory: a few words an instruction.
#pragma once

#include "program.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

namespace rtamt {

// Whether an instruction can be a member of a chain: it is one step of a strip
// (discrete/strip.hpp).
[[nodiscard]] constexpr bool fusable(Opcode opcode) noexcept {
    switch (opcode) {
    case Opcode::neg:
    case Opcode::abs:
    case Opcode::sqrt:
    case Opcode::add:
    case Opcode::sub:
    case Opcode::mul:
    case Opcode::div:
    case Opcode::min:
    case Opcode::max:
    case Opcode::holds_gt:
    case Opcode::holds_ge:
    case Opcode::holds_eq:
    case Opcode::at_least:
        return true;
    default:
        return false;
    }
}

// By instruction: the root of its chain, itself if it is computed alone; whether its chain has
// other members; and whether it is guarded.
struct Fusion {
    std::vector<std::uint32_t> roots;
    std::vector<bool> chained;
    std::vector<bool> guarded;

    // Whether an instruction has no register, since its value is read within its chain alone.
    [[nodiscard]] bool inside(std::uint32_t instruction) const noexcept {
        return roots[instruction] != instruction;
    }
};

namespace detail {

// By instruction, whether it may run in the guarded group: that is where it is, or it has no state
// and nor has what it is computed from.
[[nodiscard]] inline std::vector<bool> guardable(const Program& program,
                                                 const std::vector<bool>& guarded) {
    std::vector<bool> guardable(guarded);
    for (std::size_t i = 0; i < guardable.size(); ++i) {
        const Instruction& instruction = program.instructions[i];
        const OpcodeInfo& opcode = info(instruction.opcode);
        bool stateless = opcode.pointwise || instruction.opcode == Opcode::input ||
                         instruction.opcode == Opcode::constant;
        program.each_operand(instruction, [&](std::uint32_t operand) {
            stateless = stateless && guardable[operand];
        });
        guardable[i] = guardable[i] || stateless;
    }
    return guardable;
}

} // namespace detail

// Every instruction alone.
[[nodiscard]] inline Fusion unfused(const Program& program) {
    const std::size_t size = program.instructions.size();
    Fusion fusion{std::vector<std::uint32_t>(size), std::vector<bool>(size), program.guarded()};
    std::iota(fusion.roots.begin(), fusion.roots.end(), 0U);
    return fusion;
}

// The chains of a program, unless it leaves the pass out. `singles`: what could be a member of a
// chain is one by itself if there is no other.
[[nodiscard]] inline Fusion fused(const Program& program, bool singles = false) {
    constexpr std::uint32_t unread = std::numeric_limits<std::uint32_t>::max();
    Fusion fusion = unfused(program);
    if (!program.applies(Pass::fuse)) return fusion;
    const std::vector<bool> guardable = detail::guardable(program, fusion.guarded);
    // By instruction, the one chain that reads it; itself where others do.
    std::vector<std::uint32_t> reader(fusion.roots.size(), unread);
    for (const std::uint32_t output : program.outputs)
        reader[output] = output;
    for (auto i = static_cast<std::uint32_t>(reader.size()); i-- > 0;) {
        const Instruction& instruction = program.instructions[i];
        const bool member = fusable(instruction.opcode);
        const std::uint32_t root = reader[i] == unread ? i : reader[i];
        if (member && (!fusion.guarded[i] || guardable[root])) fusion.roots[i] = root;
        program.each_operand(instruction, [&](std::uint32_t operand) {
            const std::uint32_t chain = member ? fusion.roots[i] : operand;
            reader[operand] =
                reader[operand] == unread || reader[operand] == chain ? chain : operand;
        });
    }
    // A chain is guarded if a member is, and so is what it reads.
    for (std::uint32_t i = 0; i < reader.size(); ++i) {
        if (singles && fusable(program.instructions[i].opcode)) fusion.chained[i] = true;
        if (fusion.guarded[i]) fusion.guarded[fusion.roots[i]] = true;
        if (fusion.inside(i)) fusion.chained[i] = fusion.chained[fusion.roots[i]] = true;
    }
    for (std::size_t i = reader.size(); i-- > 0;) {
        if (!fusion.guarded[fusion.roots[i]]) continue;
        fusion.guarded[i] = true;
        program.each_operand(program.instructions[i], [&](std::uint32_t operand) {
            fusion.guarded[fusion.roots[operand]] = true;
        });
    }
    return fusion;
}

} // namespace rtamt
