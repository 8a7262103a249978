#include "discrete/wiring.hpp"

#include "check.hpp"
#include "crossing.hpp"
#include "programs.hpp"
#include "values/real.hpp"
#include "values/truth.hpp"

using programs::Builder;
using rtamt::Opcode;
using rtamt::Real;
using rtamt::Sort;
using rtamt::Truth;
using rtamt::discrete::Wiring;

TEST_CASE("a value is copied to the other bank once and only where values differ") {
    crossing::check<Wiring>(0);
}

TEST_CASE("constants of both sorts need no kernel") {
    Builder builder;
    const auto one = builder.constant(1);
    const auto a = builder.input();
    const auto holds = builder.pointwise(Opcode::holds_gt, a, one);
    builder.output(builder.pointwise(Opcode::min, holds, one));
    Wiring<Truth> wiring(builder.program());
    CHECK((crossing::units(wiring) == 2 && wiring.input_sort(0) == Sort::number));
    wiring.grow(0);
    CHECK(wiring.capacity() == Wiring<Truth>::block);
}

TEST_CASE("registers keep their last slot when they grow") {
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
