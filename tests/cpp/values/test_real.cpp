#include "values/real.hpp"

#include "laws.hpp"
#include "values/functions.hpp"

#include <limits>

using rtamt::Real;

TEST(reals_are_a_lattice) {
    laws::check_lattice<Real>();
}

TEST(nan_alone_is_undefined) {
    CHECK(Real::undefined(std::numeric_limits<double>::quiet_NaN()));
    CHECK(!Real::undefined(Real::bottom) && !Real::undefined(Real::top));
}

TEST(a_function_is_applied_as_it_is) {
    CHECK(Real::apply<rtamt::functions::Sub>(5.0, 3.0) == 2.0);
    CHECK(Real::apply<rtamt::functions::Sqrt>(9.0) == 3.0);
}
