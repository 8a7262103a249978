#include "early/late_rows.hpp"

#include "check.hpp"
#include "discrete/oracle.hpp"

#include <map>
#include <vector>

using rtamt::Bounds;
using rtamt::Snapshot;
using rtamt::early::LateRows;
using rtamt::early::Tick;

namespace {

const std::vector<Bounds> ranges{{0, 9}, {-1, 1}};

} // namespace

TEST_CASE("rows in any order are those that were set, and others have the ranges") {
    for (std::uint32_t seed = 0; seed < 50; ++seed) {
        CAPTURE(seed);
        oracle::Random random(seed);
        LateRows rows(ranges);
        std::map<Tick, std::vector<Bounds>> model;
        Tick first = 0;
        for (int i = 0; i < 200; ++i) {
            const Tick t = first + random.between(0, 20);
            const double x = random.number(0);
            rows.set(t, std::vector<Bounds>{{x, x}, ranges[1]});
            model[t] = {{x, x}, ranges[1]};
            if (random.chance(20)) {
                first += random.between(0, 4);
                rows.drop_before(first);
                model.erase(model.begin(), model.lower_bound(first));
            }
            if (random.chance(5)) {
                Snapshot written;
                rows.transfer(written);
                Snapshot read(written.bytes());
                LateRows other(ranges);
                other.transfer(read);
                read.end();
                rows = other;
            }
            REQUIRE(rows.bytes() == model.size() * (sizeof(Tick) + 2 * sizeof(Bounds)));
            for (Tick asked = first - 2; asked < first + 25; ++asked) {
                const auto found = rows.at(asked);
                const auto known = model.find(asked);
                REQUIRE(std::ranges::equal(found, known == model.end() ? ranges : known->second));
            }
        }
    }
}
