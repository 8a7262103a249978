#include "early/sample_times.hpp"

#include "check.hpp"
#include "discrete/oracle.hpp"

#include <map>

using rtamt::early::forever;
using rtamt::early::SampleTimes;
using rtamt::early::Tick;

TEST_CASE("each sample has the time that was given, in whatever order they come") {
    for (std::uint32_t seed = 0; seed < 200; ++seed) {
        CAPTURE(seed);
        oracle::Random random(seed);
        const double period = seed % 2 == 0 ? 0.1 : 1.0;
        const bool jitter = seed % 3 == 0;
        SampleTimes times(period, 0.1);
        std::map<Tick, double> given;
        for (int i = 0; i < 120; ++i) {
            const Tick newest = times.newest();
            const bool late = newest > 0 && random.chance(50);
            const Tick t = late ? random.between(0, static_cast<int>(newest))
                                : newest + (i == 0 ? 1 : random.between(1, 4));
            if (given.contains(t)) continue;
            // As one writes them down: a number of tenths, or nearly so.
            double time = period == 1.0 ? static_cast<double>(t) : static_cast<double>(t) / 10.0;
            if (jitter && random.chance(50)) time += period * 0.05;
            given[t] = time;
            if (t > newest) {
                times.add(t, time);
            } else {
                times.insert(t, time, [&](Tick before) {
                    const auto next = given.upper_bound(before);
                    return next == given.end() ? forever : next->first;
                });
            }
            for (const auto& [tick, expected] : given)
                REQUIRE(times.at(tick) == expected);
            for (Tick tick = 0; tick < times.newest(); ++tick)
                REQUIRE(times.at(tick) < times.at(tick + 1));
        }
    }
}
