#include "dense/wiring.hpp"

#include "check.hpp"
#include "programs.hpp"
#include "values/real.hpp"
#include "values/truth.hpp"

using programs::Builder;
using rtamt::Opcode;
using rtamt::Real;
using rtamt::Truth;
using rtamt::dense::Unit;
using rtamt::dense::Wiring;

namespace {

std::size_t units(const auto& wiring) {
    std::size_t count = 0;
    wiring.units().each([&](const Unit&) { ++count; });
    return count;
}

} // namespace

TEST(a_value_is_copied_to_the_other_sort_once_and_only_where_values_differ) {
    Builder builder;
    const auto a = builder.input();
    const auto sum = builder.pointwise(Opcode::add, a, builder.constant(1));
    builder.output(builder.pointwise(Opcode::neg, sum));
    builder.output(builder.unary(Opcode::run_max, sum, 0, 0)).output(sum);
    CHECK(units(Wiring<Real>(builder.program())) == 4); // the constant is one
    CHECK(units(Wiring<Truth>(builder.program())) == 5);
}

TEST(a_constant_is_one_kernel_for_each_lag_with_which_it_is_read) {
    Builder builder;
    const auto one = builder.constant(1);
    const auto a = builder.input();
    const auto b = builder.later(a, 5);
    builder.output(builder.pointwise(Opcode::max, a, one));
    builder.output(builder.pointwise(Opcode::max, b, one));
    builder.output(builder.pointwise(Opcode::min, b, one));
    CHECK(units(Wiring<Real>(builder.program())) == 6);
}
