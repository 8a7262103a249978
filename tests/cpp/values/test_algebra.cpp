#include "values/algebra.hpp"

#include "check.hpp"
#include "discrete/oracle.hpp"

using oracle::inf;
using rtamt::Clamp;
using rtamt::Max;
using rtamt::Min;

TEST_CASE("join picks the extremum and identity is neutral") {
    for (const double a : {-inf, -1.0, 0.0, 2.0, inf}) {
        CHECK((Max::join(a, Max::identity) == a && Max::join(Max::identity, a) == a));
        CHECK((Min::join(a, Min::identity) == a && Min::join(Min::identity, a) == a));
        for (const double b : {-inf, -1.0, 0.0, 2.0, inf}) {
            CHECK(Max::join(a, b) == std::max(a, b));
            CHECK(Min::join(a, b) == std::min(a, b));
        }
    }
}

TEST_CASE("composed clamps are the composition of maps") {
    oracle::Random random(1);
    for (int i = 0; i < 2000; ++i) {
        const Clamp f{random.number(10), random.number(10)};
        const Clamp g{random.number(10), random.number(10)};
        const Clamp h{random.number(10), random.number(10)};
        const double x = random.number(20);
        CHECK(f.after(g).at(x) == f.at(g.at(x)));
        CHECK(f.after(g).after(h).at(x) == f.after(g.after(h)).at(x));
        CHECK((Clamp{}.after(f).at(x) == f.at(x) && f.after(Clamp{}).at(x) == f.at(x)));
    }
}
