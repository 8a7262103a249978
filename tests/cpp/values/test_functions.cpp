#include "values/functions.hpp"

#include "check.hpp"
#include "discrete/oracle.hpp"

#include <cmath>

using namespace rtamt::functions;
using rtamt::Opcode;

TEST(functions_are_those_of_the_opcodes) {
    oracle::Random random(1);
    const auto same = [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); };
    for (int i = 0; i < 500; ++i) {
        const double a = random.number(10);
        const double b = random.number(10);
        CHECK(same(Neg::of(a), oracle::pointwise(Opcode::neg, a, b)));
        CHECK(same(Abs::of(a), oracle::pointwise(Opcode::abs, a, b)));
        CHECK(same(Log::of(a, b), oracle::pointwise(Opcode::log, a, b)));
        CHECK(same(HoldsGreater::of(a, b), oracle::pointwise(Opcode::holds_gt, a, b)));
        CHECK(same(HoldsGreaterEqual::of(a, b), oracle::pointwise(Opcode::holds_ge, a, b)));
        CHECK(same(HoldsEqual::of(a, b), oracle::pointwise(Opcode::holds_eq, a, b)));
    }
}

TEST(extrema_are_those_of_the_lattice_and_order_zeros_by_their_signs) {
    using rtamt::Real;
    for (const double a : {-oracle::inf, -1.0, -0.0, 0.0, 2.0, oracle::inf}) {
        for (const double b : {-oracle::inf, -1.0, -0.0, 0.0, 2.0, oracle::inf}) {
            CHECK(Max::of(a, b) == Real::join(a, b) && Min::of(a, b) == Real::meet(a, b));
            CHECK(Real::same(Max::of(a, b), Max::of(b, a)));
            CHECK(Real::same(Min::of(a, b), Min::of(b, a)));
        }
    }
    CHECK(Real::same(Max::of(0.0, -0.0), 0.0) && Real::same(Min::of(0.0, -0.0), -0.0));
}

TEST(partial_functions_are_those_that_make_nan) {
    CHECK(Sqrt::partial && std::isnan(Sqrt::of(-1)) && Sub::partial);
    CHECK(!Exp::partial && !HoldsEqual::partial && !Abs::partial);
}
