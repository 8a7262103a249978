#include "discrete/wiring.hpp"

#include "check.hpp"
#include "programs.hpp"
#include "values/real.hpp"
#include "values/truth.hpp"

using programs::Builder;
using rtamt::Opcode;
using rtamt::Real;
using rtamt::Sort;
using rtamt::Truth;
using rtamt::discrete::Unit;
using rtamt::discrete::Wiring;

namespace {

std::size_t units(const auto& wiring) {
    std::size_t count = 0;
    wiring.units().each([&](const Unit&) { ++count; });
    return count;
}

} // namespace

TEST(a_value_is_copied_to_the_other_bank_once_and_only_where_values_differ) {
    Builder builder;
    const auto a = builder.input();
    const auto sum = builder.pointwise(Opcode::add, a, builder.constant(1));
    builder.output(builder.pointwise(Opcode::neg, sum));
    builder.output(builder.unary(Opcode::run_max, sum, 0, 0)).output(sum);
    CHECK(units(Wiring<Real>(builder.program())) == 3);
    CHECK(units(Wiring<Truth>(builder.program())) == 4);
}

TEST(constants_of_both_sorts_need_no_kernel) {
    Builder builder;
    const auto one = builder.constant(1);
    const auto a = builder.input();
    const auto holds = builder.pointwise(Opcode::holds_gt, a, one);
    builder.output(builder.pointwise(Opcode::min, holds, one));
    Wiring<Truth> wiring(builder.program());
    CHECK(units(wiring) == 2 && wiring.input_sort(0) == Sort::number);
    wiring.grow(0);
    CHECK(wiring.capacity() == Wiring<Truth>::block);
}

TEST(registers_keep_their_last_slot_when_they_grow) {
    Builder builder;
    const auto a = builder.input();
    builder.output(builder.pointwise(Opcode::neg, a));
    Wiring<Real> wiring(builder.program());
    const double sample = 2.5;
    wiring.numbers().load(&sample);
    wiring.formulas().load(&sample);
    wiring.grow(0);
    CHECK(wiring.value(a, 0) == 2.5);
    CHECK(wiring.bytes() > std::size_t{16} * Wiring<Real>::block);
}
