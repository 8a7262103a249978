// The laws of a value domain, over samples of its values.
#pragma once

#include "check.hpp"
#include "discrete/oracle.hpp"
#include "values/domain.hpp"
#include "values/interval.hpp"
#include "values/lanes.hpp"
#include "values/real.hpp"
#include "values/truth.hpp"

#include <array>
#include <cstddef>
#include <random>
#include <vector>

namespace laws {

// A random value of a domain: many are equal, some are infinite.
template <class D>
struct Sampler;

template <>
struct Sampler<rtamt::Real> {
    static double one(oracle::Random& random) { return random.number(10); }
};
template <>
struct Sampler<rtamt::Interval> {
    static rtamt::Bounds one(oracle::Random& random) {
        const double a = random.number(10);
        const double b = random.chance(30) ? a : random.number(10);
        return {std::min(a, b), std::max(a, b)};
    }
};
template <std::size_t n>
struct Sampler<rtamt::Lanes<n>> {
    static typename rtamt::Lanes<n>::Value one(oracle::Random& random) {
        typename rtamt::Lanes<n>::Value value{};
        for (double& lane : value.lane)
            lane = random.number(10);
        return value;
    }
};
template <>
struct Sampler<rtamt::Truth> {
    static std::uint64_t one(oracle::Random& random) {
        return static_cast<std::uint64_t>(random.between(0, 0xFFFFFFFF)) << 32U |
               static_cast<std::uint64_t>(random.between(0, 0xFFFFFFFF));
    }
};

template <rtamt::ValueDomain D>
void check_lattice() {
    oracle::Random random(1);
    const auto one = [&] { return Sampler<D>::one(random); };
    for (int i = 0; i < 2000; ++i) {
        const auto a = one();
        const auto b = one();
        const auto c = one();
        CHECK((D::join(a, a) == a && D::meet(a, a) == a));
        CHECK((D::join(a, b) == D::join(b, a) && D::meet(a, b) == D::meet(b, a)));
        CHECK(D::join(a, D::join(b, c)) == D::join(D::join(a, b), c));
        CHECK(D::meet(a, D::meet(b, c)) == D::meet(D::meet(a, b), c));
        CHECK((D::join(a, D::meet(a, b)) == a && D::meet(a, D::join(a, b)) == a));
        CHECK(D::join(a, D::meet(b, c)) == D::meet(D::join(a, b), D::join(a, c)));
        CHECK((D::join(a, D::bottom) == a && D::meet(a, D::top) == a));
        CHECK((D::join(a, D::top) == D::top && D::meet(a, D::bottom) == D::bottom));
        CHECK(D::neg(D::neg(a)) == a);
        CHECK(D::neg(D::join(a, b)) == D::meet(D::neg(a), D::neg(b)));
        CHECK(!D::undefined(a));
        if (D::total) CHECK((D::join(a, b) == a || D::join(a, b) == b));
    }
    CHECK((D::of(oracle::inf) == D::top && D::of(-oracle::inf) == D::bottom));
    CHECK(D::neg(D::top) == D::bottom);
}

} // namespace laws
