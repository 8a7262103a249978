#include "values/monoid.hpp"

#include "laws.hpp"

using namespace rtamt;

namespace {

template <Monoid M, class Element>
void check_monoid(Element&& element) {
    for (int i = 0; i < 1000; ++i) {
        const typename M::Element a = element();
        const typename M::Element b = element();
        const typename M::Element c = element();
        CHECK(M::result(M::append(M::identity, a)) == M::result(a));
        CHECK(M::result(M::prepend(a, M::identity)) == M::result(a));
        CHECK(M::result(M::append(M::append(a, b), c)) ==
              M::result(M::prepend(a, M::append(b, c))));
        CHECK(M::result(a, b) == M::result(M::append(a, b)));
    }
}

template <ValueDomain D>
void check_monoids() {
    oracle::Random random(1);
    const auto one = [&] { return laws::Sampler<D>::one(random); };
    check_monoid<Joined<MaxOf<D>>>(one);
    check_monoid<Joined<MinOf<D>>>(one);
    check_monoid<UntilSteps<D>>([&] { return UntilSteps<D>::element(one(), one()); });
}

} // namespace

TEST_CASE("extrema and until are monoids over every domain") {
    check_monoids<Real>();
    check_monoids<Interval>();
    check_monoids<Lanes<8>>();
    check_monoids<Truth>();
}
