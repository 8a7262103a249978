#include "dense/wiring.hpp"

#include "check.hpp"
#include "crossing.hpp"
#include "programs.hpp"
#include "values/real.hpp"
#include "values/truth.hpp"

using programs::Builder;
using rtamt::Opcode;
using rtamt::Real;
using rtamt::Truth;
using rtamt::dense::Wiring;

TEST_CASE("a value is copied to the other sort once and only where values differ") {
    crossing::check<Wiring>(1);
}

TEST_CASE("a constant is one kernel for each lag with which it is read") {
    Builder builder;
    const auto one = builder.constant(1);
    const auto a = builder.input();
    const auto b = builder.later(a, 5);
    builder.output(builder.pointwise(Opcode::max, a, one));
    builder.output(builder.pointwise(Opcode::max, b, one));
    builder.output(builder.pointwise(Opcode::min, b, one));
    CHECK(crossing::units(Wiring<Real>(builder.program())) == 6);
}
