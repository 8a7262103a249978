#include "early/sliding.hpp"

#include "check.hpp"
#include "oracle.hpp"

#include <algorithm>
#include <vector>

using namespace early_oracle;
using rtamt::early::Sliding;

TEST_CASE("the extreme values of sliding windows are those of all their values") {
    for (std::uint32_t seed = 0; seed < 40; ++seed) {
        CAPTURE(seed);
        Random random(seed);
        const bool greatest = seed % 2 == 0;
        const double outer = greatest ? -rtamt::infinity : rtamt::infinity;
        const std::int64_t values = seed % 3 == 0 ? 2 : 50;
        Sliding sliding(greatest);
        std::vector<double> model;
        Tick from = 0;
        for (Tick t = 0; t < 300; t = std::ssize(model)) {
            const Tick last = t + (random.chance(20) ? random.between(1, 5) : 0);
            // Long stretches without a change let many values pile up.
            const double falling = t % 150 < 80 ? static_cast<double>(greatest ? -t : t) : 0.0;
            const double value = falling + static_cast<double>(random.between(0, values));
            sliding.add(last, value);
            model.resize(static_cast<std::size_t>(last + 1), value);
            from = random.between(from, std::min(last + 1, from + 9));
            double expected = outer;
            for (Tick k = from; k <= last; ++k) {
                const double each = model[static_cast<std::size_t>(k)];
                expected = greatest ? std::max(expected, each) : std::min(expected, each);
            }
            REQUIRE(sliding.from(from) == expected);
        }
        sliding.clear();
        REQUIRE(sliding.from(from) == outer);
    }
}
