#include "discrete/scan.hpp"

#include "check.hpp"
#include "oracle.hpp"
#include "values/interval.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

using oracle::inf;
using oracle::Signal;

TEST_CASE("scans are the suprema and infima over the rest of the trace") {
    oracle::Random random(2);
    for (const std::size_t size : std::initializer_list<std::size_t>{0, 1, 2, 3, 50}) {
        const Signal phi = random.signal(size, 5);
        const Signal psi = random.signal(size, 5);
        Signal most(size);
        Signal least(size);
        Signal until(size);
        rtamt::discrete::scan<rtamt::Max>(phi, most);
        rtamt::discrete::scan<rtamt::Min>(phi, least);
        rtamt::discrete::scan_until<rtamt::Real>(phi, psi, until);
        for (std::size_t t = 0; t < size; ++t) {
            double eventually = -inf;
            double always = inf;
            double best = -inf;
            for (std::size_t later = t; later < size; ++later) {
                best = std::max(best, std::min(psi[later], always)); // phi on [t, later)
                eventually = std::max(eventually, phi[later]);
                always = std::min(always, phi[later]);
            }
            CHECK((most[t] == eventually && least[t] == always && until[t] == best));
        }
    }
}

TEST_CASE("phi is not required where psi holds") {
    const Signal phi{-1, -1, -1};
    const Signal psi{3, 3, 3};
    Signal until(3);
    rtamt::discrete::scan_until<rtamt::Real>(phi, psi, until);
    CHECK((until == Signal{3, 3, 3}));
}

TEST_CASE("scans of bounds are the scans of the lower and of the upper bounds") {
    oracle::Random random(3);
    std::vector<rtamt::Bounds> phi(40);
    std::vector<rtamt::Bounds> psi(40);
    std::array<std::array<Signal, 2>, 2> ends; // of phi and psi: lower, upper
    for (std::size_t i = 0; i < phi.size(); ++i) {
        for (auto& [signal, end] : {std::pair(&phi, &ends[0]), std::pair(&psi, &ends[1])}) {
            const double a = random.number(5);
            const double b = random.number(5);
            (*signal)[i] = {std::min(a, b), std::max(a, b)};
            (*end)[0].push_back((*signal)[i].lower);
            (*end)[1].push_back((*signal)[i].upper);
        }
    }
    std::vector<rtamt::Bounds> most(phi.size());
    std::vector<rtamt::Bounds> until(phi.size());
    rtamt::discrete::scan<rtamt::MaxOf<rtamt::Interval>>(phi, most);
    rtamt::discrete::scan_until<rtamt::Interval>(phi, psi, until);
    for (const std::size_t end : {0U, 1U}) {
        Signal expected_most(phi.size());
        Signal expected_until(phi.size());
        rtamt::discrete::scan<rtamt::Max>(ends[0][end], expected_most);
        rtamt::discrete::scan_until<rtamt::Real>(ends[0][end], ends[1][end], expected_until);
        for (std::size_t i = 0; i < phi.size(); ++i) {
            CHECK((end == 0 ? most[i].lower : most[i].upper) == expected_most[i]);
            CHECK((end == 0 ? until[i].lower : until[i].upper) == expected_until[i]);
        }
    }
}
