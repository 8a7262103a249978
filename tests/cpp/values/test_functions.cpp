#include "values/functions.hpp"

#include "check.hpp"
#include "discrete/oracle.hpp"

#include <cmath>

using namespace rtamt::functions;
using rtamt::Opcode;

TEST_CASE("functions are those of the opcodes") {
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

TEST_CASE("a zero of either sign has the same result") {
    const auto same = [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); };
    const auto check = [&](auto function) {
        for (const double a : {-oracle::inf, -3.0, -1.0, -0.0, 0.0, 0.5, 2.0, oracle::inf}) {
            CHECK(same(function.of(a, -0.0), function.of(a, 0.0)));
            CHECK(same(function.of(-0.0, a), function.of(0.0, a)));
        }
    };
    check(Add{});
    check(Sub{});
    check(Mul{});
    check(Div{});
    check(Pow{});
    check(Log{});
    check(HoldsGreater{});
    check(HoldsGreaterEqual{});
    check(HoldsEqual{});
    CHECK((Div::of(1.0, -0.0) == oracle::inf && Pow::of(-0.0, -1.0) == oracle::inf));
}

TEST_CASE("partial functions are those that make nan") {
    CHECK((Sqrt::partial && std::isnan(Sqrt::of(-1)) && Sub::partial));
    CHECK((!Exp::partial && !HoldsEqual::partial && !Abs::partial));
}
