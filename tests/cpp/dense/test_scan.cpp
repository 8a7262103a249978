#include "dense/scan.hpp"

#include "ways.hpp"

#include <algorithm>

using dense_oracle::at;
using dense_oracle::inf;
using dense_oracle::signal_of;
using ways::Random;
using ways::Signal;

TEST(scans_are_the_suprema_and_infima_over_the_rest_of_time) {
    Random random(8);
    for (int round = 0; round < 200; ++round) {
        const auto trace = dense_oracle::random_trace(random, 2, 20, 0, 5);
        const Signal& phi = trace[0];
        const Signal& psi = trace[1];
        const std::int64_t end = dense_oracle::end_of(trace);
        Signal most;
        Signal least;
        for (std::int64_t t = phi.times.front(); t <= end; ++t) {
            double eventually = -inf;
            double always = inf;
            for (std::int64_t s = t; s <= end; ++s) {
                eventually = std::max(eventually, at(phi, s));
                always = std::min(always, at(phi, s));
            }
            most.add(t, eventually);
            least.add(t, always);
        }
        Signal until;
        for (std::int64_t t = dense_oracle::start_of(trace); t <= end; ++t) {
            double best = -inf;
            double held = inf;
            for (std::int64_t s = t; s <= end; ++s) {
                best = std::max(best, std::min(at(psi, s), held)); // phi on [t, s)
                held = std::min(held, at(phi, s));
            }
            until.add(t, best);
        }
        const auto first = phi.events(0, phi.size());
        const auto second = psi.events(0, psi.size());
        CHECK(signal_of(rtamt::dense::scan<rtamt::Max>(first).view()) == most.merged());
        CHECK(signal_of(rtamt::dense::scan<rtamt::Min>(first).view()) == least.merged());
        CHECK(signal_of(rtamt::dense::scan_until(first, second).view()) == until.merged());
    }
}

TEST(a_scan_of_nothing_is_nothing) {
    CHECK(rtamt::dense::scan<rtamt::Max>({}).count() == 0);
    CHECK(rtamt::dense::scan_until({}, {}).count() == 0);
}
