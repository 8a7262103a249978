#include "early/step_map.hpp"

#include "check.hpp"
#include "oracle.hpp"
#include "program/snapshot.hpp"
#include "values/bounds.hpp"

#include <algorithm>
#include <vector>

using namespace early_oracle;
using namespace rtamt::early;
using rtamt::Bounds;

namespace {

constexpr Tick ticks = 400;
constexpr Bounds range{-9.0, 9.0};

// Sets single ticks, most of them near the end as samples are, and compares each access with an
// array.
void check_bounds(std::uint32_t seed, int values, Tick late) {
    CAPTURE(seed);
    Random random(seed);
    StepMap<Bounds> map(0, range);
    std::vector<Bounds> model(static_cast<std::size_t>(ticks) + 1, range); // the last for ever
    Tick front = 0;
    for (Tick newest = 0; newest < ticks; ++newest) {
        const Tick t = std::max(front, newest - random.between(0, late));
        const auto lower = static_cast<double>(random.between(0, values));
        const Bounds bounds{lower, lower + static_cast<double>(random.between(0, 1))};
        map.set(t, t, bounds);
        model[static_cast<std::size_t>(t)] = bounds;
        if (random.chance(5)) {
            front = std::max(front, newest - late);
            map.drop_before(front);
            REQUIRE(map.front() <= front);
        }
        if (random.chance(3)) {
            rtamt::Snapshot written;
            map.transfer(written);
            rtamt::Snapshot read(written.bytes());
            StepMap<Bounds> other(0, range);
            other.transfer(read);
            read.end();
            map = other;
        }
        for (Tick k = front; k <= newest + 1; ++k) {
            const auto found = map.at(std::min(k, ticks));
            REQUIRE(found.value == model[static_cast<std::size_t>(std::min(k, ticks))]);
            REQUIRE(found.begin <= k);
            REQUIRE(found.end >= k);
        }
        REQUIRE(map.at(forever).end == forever);
    }
}

} // namespace

TEST_CASE("bounds are those of an array, wherever they are set") {
    for (std::uint32_t seed = 0; seed < 12; ++seed)
        check_bounds(seed, seed % 2 == 0 ? 1 : 40, seed % 3 == 0 ? 3 : 100);
}

TEST_CASE("runs with equal bounds are one") {
    StepMap<Bounds> map(0, range);
    map.set(3, 5, {1.0, 2.0});
    map.set(6, 7, {1.0, 2.0});
    CHECK(map.at(4).begin == 3);
    CHECK(map.at(4).end == 7);
    map.set(5, 5, range);
    CHECK(map.at(4).end == 4);
    CHECK(map.at(5).end == 5);
    CHECK(map.at(6).end == 7);
}
