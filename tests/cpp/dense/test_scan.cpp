#include "dense/scan.hpp"

#include "values/truth.hpp"
#include "ways.hpp"

#include <algorithm>

using dense_oracle::at;
using dense_oracle::inf;
using dense_oracle::signal_of;
using ways::Random;
using ways::Signal;

TEST_CASE("scans are the suprema and infima over the rest of time") {
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
        CHECK(signal_of(rtamt::dense::scan_until<rtamt::Real>(first, second).view()) ==
              until.merged());
    }
}

TEST_CASE("a scan of nothing is nothing") {
    CHECK(rtamt::dense::scan<rtamt::Max>({}).count() == 0);
    CHECK(rtamt::dense::scan_until<rtamt::Real>({}, {}).count() == 0);
}

TEST_CASE("scans compute 64 truth values at once") {
    const std::vector<std::int64_t> times{0, 5, 7};
    const std::vector<std::uint64_t> phi{0b110, 0b011, 0b011};
    const std::vector<std::uint64_t> psi{0b000, 0b100, 0b001};
    const rtamt::dense::BasicEvents<std::uint64_t> a{times.data(), phi.data(), 3};
    const rtamt::dense::BasicEvents<std::uint64_t> b{times.data(), psi.data(), 3};
    const auto most = rtamt::dense::scan<rtamt::MaxOf<rtamt::Truth>>(a);
    CHECK(most.count() == 2); // the last two are equal
    CHECK(most.view().values[0] == 0b111);
    CHECK(most.view().values[1] == 0b011);
    const auto until = rtamt::dense::scan_until<rtamt::Truth>(a, b);
    CHECK(until.count() == 3);
    CHECK(until.view().values[0] == 0b100);
    CHECK(until.view().values[1] == 0b101);
    CHECK(until.view().values[2] == 0b001);
}
