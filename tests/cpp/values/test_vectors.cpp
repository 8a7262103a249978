#include "values/vectors.hpp"

#include "check.hpp"
#include "discrete/pointwise.hpp"
#include "values/functions.hpp"

#include <cstring>
#include <limits>
#include <vector>

using rtamt::discrete::Range;
using Divide = rtamt::discrete::Binary<rtamt::operations::Map<rtamt::Real, rtamt::functions::Div>>;

TEST_CASE("a loop gives the same bits and finds the same nan however wide") {
    constexpr double inf = std::numeric_limits<double>::infinity();
    std::vector<double> a;
    std::vector<double> b;
    for (int i = 0; i < 101; ++i) {
        a.push_back(i % 7 == 0 ? inf : 0.1 * i);
        b.push_back(i % 5 == 0 ? -0.0 : 3.0 - i);
    }
    for (const bool undefined : {false, true}) {
        if (undefined) b[77] = inf; // inf / inf
        std::vector<double> wide(a.size());
        std::vector<double> narrow(a.size());
        const Range range{1, 100};
        const double* const first = a.data();
        const double* const second = b.data();
        const std::size_t found =
            rtamt::vectorised<Divide>(range.end - range.begin, wide.data(), first, second, range);
        CHECK(found == Divide::over(narrow.data(), first, second, range));
        CHECK(found == (undefined ? std::size_t{77} : rtamt::discrete::Kernel::defined));
        if (!undefined) {
            CHECK(std::memcmp(wide.data(), narrow.data(), a.size() * sizeof(double)) == 0);
        }
    }
}
