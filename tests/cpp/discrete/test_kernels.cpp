#include "discrete/kernels.hpp"

#include "check.hpp"
#include "each_opcode.hpp"
#include "values/interval.hpp"
#include "values/lanes.hpp"
#include "values/real.hpp"
#include "values/truth.hpp"

using rtamt::Instruction;
using rtamt::Interval;
using rtamt::Lanes;
using rtamt::Opcode;
using rtamt::Real;
using rtamt::Sort;
using rtamt::Truth;
using rtamt::discrete::Kernels;

namespace {

template <class D>
void check_opcodes() {
    each_opcode([](const Instruction& instruction, bool computes, Sort sort) {
        const auto kernel = Kernels<D>::make(instruction, sort, 0, nullptr, nullptr);
        CHECK((kernel != nullptr) == computes);
    });
}

} // namespace

TEST_CASE("every opcode that computes has a kernel in every domain") {
    check_opcodes<Real>();
    check_opcodes<Interval>();
    check_opcodes<Lanes<8>>();
    check_opcodes<Truth>();
}

TEST_CASE("only windows, shares and shifts keep samples") {
    for (std::size_t code = 0; code < rtamt::opcodes.size(); ++code) {
        Instruction instruction;
        instruction.opcode = static_cast<Opcode>(code);
        instruction.n = 10;
        const auto count = rtamt::opcodes[code].count;
        // A share keeps each value with its places in two heaps, and those of every trace apart.
        const bool ranks = count == rtamt::Count::rank;
        const bool keeps = ranks || count == rtamt::Count::width || count == rtamt::Count::distance;
        const std::size_t values = instruction.opcode == Opcode::until ? 20 : 10;
        const std::size_t expected = keeps ? values * (ranks ? 24 : 8) : 0;
        CHECK(Kernels<Real>::state_size(instruction, Sort::formula) == expected);
        CHECK(Kernels<Truth>::state_size(instruction, Sort::formula) ==
              (ranks ? 64 : 1) * expected);
        CHECK(Kernels<Interval>::state_size(instruction, Sort::formula) == 2 * expected);
        CHECK(Kernels<Lanes<8>>::state_size(instruction, Sort::formula) == 8 * expected);
        if (instruction.opcode == Opcode::until) continue; // is never a number
        CHECK(Kernels<Truth>::state_size(instruction, Sort::number) == 64 * expected);
    }
}
