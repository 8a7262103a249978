#include "dense/kernels.hpp"

#include "../check.hpp"

using rtamt::Instruction;
using rtamt::Opcode;
using rtamt::dense::make_kernel;

TEST(every_opcode_that_computes_has_a_kernel) {
    for (std::size_t code = 0; code < rtamt::opcodes.size(); ++code) {
        Instruction instruction;
        instruction.opcode = static_cast<Opcode>(code);
        const auto kernel = make_kernel(instruction);
        CHECK((kernel != nullptr) == (rtamt::opcodes[code].operands > 0));
        if (kernel) CHECK(kernel->bytes() == 0 && kernel->pending() == 0);
    }
}
