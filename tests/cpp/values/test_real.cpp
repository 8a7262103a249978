#include "values/real.hpp"

#include "laws.hpp"
#include "values/functions.hpp"

#include <limits>

using rtamt::Real;

TEST_CASE("reals are a lattice") {
    laws::check_lattice<Real>();
}

TEST_CASE("nan alone is undefined") {
    CHECK(Real::undefined(std::numeric_limits<double>::quiet_NaN()));
    CHECK((!Real::undefined(Real::bottom) && !Real::undefined(Real::top)));
}

TEST_CASE("a function is applied as it is") {
    CHECK(Real::apply<rtamt::functions::Sub>(5.0, 3.0) == 2.0);
    CHECK(Real::apply<rtamt::functions::Sqrt>(9.0) == 3.0);
}
