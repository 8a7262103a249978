// Every opcode, as an instruction for each sort of value that it gives.
#pragma once

#include "program/opcodes.hpp"
#include "program/program.hpp"
#include "program/sorts.hpp"

#include <cstddef>

template <class Check>
void each_opcode(Check&& check) {
    for (std::size_t code = 0; code < rtamt::opcodes.size(); ++code) {
        rtamt::Instruction instruction;
        instruction.opcode = static_cast<rtamt::Opcode>(code);
        const auto& opcode = rtamt::opcodes[code];
        for (const rtamt::Sort sort : {rtamt::Sort::number, rtamt::Sort::formula}) {
            if (opcode.gives == rtamt::Sort::either || opcode.gives == sort)
                check(instruction, opcode.operands > 0, sort);
        }
    }
}
