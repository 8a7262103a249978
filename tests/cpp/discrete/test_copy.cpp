#include "discrete/copy.hpp"

#include "check.hpp"

#include <array>

TEST_CASE("exactly the given number of cells is written") {
    const std::array<double, 4> source{1, 2, 3, 4};
    for (std::size_t count = 0; count <= 4; ++count) {
        std::array<double, 4> copied{-1, -1, -1, -1};
        std::array<double, 4> filled{-1, -1, -1, -1};
        rtamt::discrete::copy_values(source.data(), count, copied.data());
        rtamt::discrete::fill_values(filled.data(), count, 7.0);
        for (std::size_t i = 0; i < 4; ++i) {
            CHECK(copied[i] == (i < count ? source[i] : -1.0));
            CHECK(filled[i] == (i < count ? 7.0 : -1.0));
        }
    }
}
