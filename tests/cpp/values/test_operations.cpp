#include "values/operations.hpp"

#include "laws.hpp"
#include "values/functions.hpp"

using namespace rtamt;

TEST_CASE("operations are those of the domain") {
    oracle::Random random(1);
    for (int i = 0; i < 200; ++i) {
        const Bounds a = laws::Sampler<Interval>::one(random);
        const Bounds b = laws::Sampler<Interval>::one(random);
        CHECK(operations::Not<Interval>::of(a) == Interval::neg(a));
        CHECK(operations::Connect<MaxOf<Interval>>::of(a, b) == Interval::join(a, b));
        CHECK(operations::Connect<MinOf<Interval>>::of(a, b) == Interval::meet(a, b));
        CHECK((operations::Map<Interval, functions::Neg>::of(a) == Interval::neg(a)));
    }
}

TEST_CASE("a predicate takes numbers and gives a formula") {
    oracle::Random random(2);
    using Greater = operations::Test<Truth, functions::HoldsGreater>;
    const auto a = laws::Sampler<Lanes<64>>::one(random);
    CHECK(Greater::of(a, Lanes<64>::of(0)) == operations::ToFormula<Truth>::of(a));
    CHECK(operations::ToFormula<Truth>::of(operations::ToNumber<Truth>::of(77)) == 77);
    CHECK((operations::Test<Real, functions::HoldsGreater>::of(2, 1) == infinity));
}

TEST_CASE("only partial functions are partial operations") {
    CHECK((operations::Map<Real, functions::Div>::partial));
    CHECK((!operations::Map<Real, functions::Exp>::partial));
    CHECK((!operations::Test<Truth, functions::HoldsEqual>::partial));
}
