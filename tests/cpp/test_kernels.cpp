#include "discrete/kernels.hpp"

#include "check.hpp"

using rtamt::Instruction;
using rtamt::Opcode;
using rtamt::discrete::make_kernel;
using rtamt::discrete::state_size;

TEST(every_opcode_that_computes_has_a_kernel) {
    for (std::size_t code = 0; code < rtamt::opcodes.size(); ++code) {
        Instruction instruction;
        instruction.opcode = static_cast<Opcode>(code);
        const auto kernel = make_kernel(instruction, 0, nullptr, nullptr);
        CHECK((kernel != nullptr) == (rtamt::opcodes[code].operands > 0));
    }
}

TEST(only_windows_and_shifts_keep_samples) {
    for (std::size_t code = 0; code < rtamt::opcodes.size(); ++code) {
        Instruction instruction;
        instruction.opcode = static_cast<Opcode>(code);
        instruction.n = 10;
        const auto count = rtamt::opcodes[code].count;
        const bool keeps = count == rtamt::Count::width || count == rtamt::Count::distance;
        const std::size_t expected = instruction.opcode == Opcode::until ? 20 : 10;
        CHECK(state_size(instruction) == (keeps ? expected : 0));
    }
}
