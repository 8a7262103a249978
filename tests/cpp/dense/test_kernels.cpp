#include "dense/kernels.hpp"

#include "check.hpp"
#include "values/interval.hpp"
#include "values/lanes.hpp"
#include "values/real.hpp"
#include "values/truth.hpp"

using rtamt::Instruction;
using rtamt::Opcode;
using rtamt::Sort;
using rtamt::dense::Kernels;

namespace {

template <class D>
void check_opcodes() {
    for (std::size_t code = 0; code < rtamt::opcodes.size(); ++code) {
        Instruction instruction;
        instruction.opcode = static_cast<Opcode>(code);
        const auto& opcode = rtamt::opcodes[code];
        for (const Sort sort : {Sort::number, Sort::formula}) {
            if (opcode.gives != Sort::either && opcode.gives != sort) continue;
            const auto kernel = Kernels<D>::make(instruction, sort);
            // Sums of step signals are lines, which dense time does not have.
            const bool sums =
                instruction.opcode == Opcode::slide_sum || instruction.opcode == Opcode::run_sum;
            CHECK((kernel != nullptr) == (opcode.operands > 0 && !sums));
            if (!kernel) continue;
            CHECK(kernel->pending() == 0);
            // A share keeps a tree, which has a root before there is a sample.
            const bool ranks =
                instruction.opcode == Opcode::rank_max || instruction.opcode == Opcode::rank_min;
            CHECK((ranks || kernel->bytes() == 0));
        }
    }
}

} // namespace

TEST_CASE("every opcode that computes has a kernel in every domain") {
    check_opcodes<rtamt::Real>();
    check_opcodes<rtamt::Interval>();
    check_opcodes<rtamt::Lanes<8>>();
    check_opcodes<rtamt::Truth>();
}
