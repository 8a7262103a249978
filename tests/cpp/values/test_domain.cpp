#include "values/domain.hpp"

#include "laws.hpp"

using rtamt::Interval;
using rtamt::Lanes;
using rtamt::Real;
using rtamt::Truth;
using rtamt::UniformDomain;
using rtamt::ValueDomain;

namespace {

struct NoMeet : Real {
    static double meet(double a, double b) = delete;
};

} // namespace

TEST_CASE("a domain has every operation") {
    CHECK((ValueDomain<Real> && ValueDomain<Interval> && ValueDomain<Lanes<8>>));
    CHECK(ValueDomain<Truth>);
    CHECK((!ValueDomain<NoMeet> && !ValueDomain<int>));
}

TEST_CASE("truth alone has other values for numbers") {
    CHECK((UniformDomain<Real> && UniformDomain<Interval> && UniformDomain<Lanes<8>>));
    CHECK((!UniformDomain<Truth> && UniformDomain<Truth::Number>));
}
