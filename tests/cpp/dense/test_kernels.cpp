#include "dense/kernels.hpp"

#include "check.hpp"
#include "each_opcode.hpp"
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
    each_opcode([](const Instruction& instruction, bool computes, Sort sort) {
        const auto kernel = Kernels<D>::make(instruction, sort);
        CHECK((kernel != nullptr) == computes);
        if (!kernel) return;
        CHECK(kernel->pending() == 0);
        // A share keeps a tree, which has a root before there is a sample.
        const bool ranks =
            instruction.opcode == Opcode::rank_max || instruction.opcode == Opcode::rank_min;
        CHECK((ranks || kernel->bytes() == 0));
    });
}

} // namespace

TEST_CASE("every opcode that computes has a kernel in every domain") {
    check_opcodes<rtamt::Real>();
    check_opcodes<rtamt::Interval>();
    check_opcodes<rtamt::Lanes<8>>();
    check_opcodes<rtamt::Truth>();
}
