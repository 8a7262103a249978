#include "values/lanes.hpp"

#include "laws.hpp"
#include "values/functions.hpp"

#include <limits>

using rtamt::Lanes;
using rtamt::Real;

TEST_CASE("lanes are a lattice") {
    laws::check_lattice<Lanes<1>>();
    laws::check_lattice<Lanes<3>>();
    laws::check_lattice<Lanes<8>>();
}

TEST_CASE("each lane is a real") {
    using Eight = Lanes<8>;
    oracle::Random random(2);
    for (int i = 0; i < 500; ++i) {
        auto a = laws::Sampler<Eight>::one(random);
        auto b = laws::Sampler<Eight>::one(random);
        a.lane[0] = b.lane[1] = 0.0; // of which the operands' order may choose
        a.lane[1] = b.lane[0] = -0.0;
        for (std::size_t k = 0; k < 8; ++k) {
            CHECK(Eight::join(a, b).lane[k] == Real::join(a.lane[k], b.lane[k]));
            CHECK(Eight::meet(a, b).lane[k] == Real::meet(a.lane[k], b.lane[k]));
            CHECK(Eight::neg(a).lane[k] == -a.lane[k]);
            CHECK(Eight::apply<rtamt::functions::Div>(a, Eight::of(4)).lane[k] == a.lane[k] / 4);
            CHECK(Eight::apply<rtamt::functions::Abs>(a).lane[k] == std::fabs(a.lane[k]));
        }
    }
}

TEST_CASE("one undefined lane makes a value undefined") {
    for (std::size_t k = 0; k < 8; ++k) {
        auto value = Lanes<8>::of(1.0);
        CHECK(!Lanes<8>::undefined(value));
        value.lane[k] = std::numeric_limits<double>::quiet_NaN();
        CHECK(Lanes<8>::undefined(value));
    }
}
