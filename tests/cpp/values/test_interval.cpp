#include "values/interval.hpp"

#include "laws.hpp"

using rtamt::Bounds;
using rtamt::Interval;

TEST_CASE("intervals are a lattice") {
    laws::check_lattice<Interval>();
}

TEST_CASE("an undefined bound makes a value undefined") {
    CHECK(Interval::undefined(rtamt::bounds::nothing));
    CHECK(!Interval::undefined(rtamt::bounds::anything));
}

TEST_CASE("known numbers give what the function gives") {
    using namespace rtamt::functions;
    oracle::Random random(5);
    for (int i = 0; i < 1000; ++i) {
        const double a = random.number(10);
        const double b = random.number(10);
        const auto same = [](double x, Bounds bounds) {
            return std::isnan(x) ? Interval::undefined(bounds) : bounds == Interval::of(x);
        };
        CHECK(same(Exp::of(a), Interval::apply<Exp>(Interval::of(a))));
        CHECK(same(Ln::of(a), Interval::apply<Ln>(Interval::of(a))));
        CHECK(same(Sqrt::of(a), Interval::apply<Sqrt>(Interval::of(a))));
        CHECK(same(Sub::of(a, b), Interval::apply<Sub>(Interval::of(a), Interval::of(b))));
        CHECK(same(Mul::of(a, b), Interval::apply<Mul>(Interval::of(a), Interval::of(b))));
        CHECK(same(Div::of(a, b), Interval::apply<Div>(Interval::of(a), Interval::of(b))));
        CHECK(same(Pow::of(a, b), Interval::apply<Pow>(Interval::of(a), Interval::of(b))));
        CHECK(same(Log::of(a, b), Interval::apply<Log>(Interval::of(a), Interval::of(b))));
        CHECK(same(HoldsGreater::of(a, b),
                   Interval::apply<HoldsGreater>(Interval::of(a), Interval::of(b))));
    }
}
