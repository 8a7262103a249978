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

TEST(a_domain_has_every_operation) {
    CHECK((ValueDomain<Real> && ValueDomain<Interval> && ValueDomain<Lanes<8>>));
    CHECK(ValueDomain<Truth>);
    CHECK(!ValueDomain<NoMeet> && !ValueDomain<int>);
}

TEST(truth_alone_has_other_values_for_numbers) {
    CHECK((UniformDomain<Real> && UniformDomain<Interval> && UniformDomain<Lanes<8>>));
    CHECK(!UniformDomain<Truth> && UniformDomain<Truth::Number>);
}
