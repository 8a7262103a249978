#include "discrete/scan.hpp"

#include "check.hpp"
#include "oracle.hpp"

using oracle::inf;
using oracle::Signal;

TEST(scans_are_the_suprema_and_infima_over_the_rest_of_the_trace) {
    oracle::Random random(2);
    for (const std::size_t size : std::initializer_list<std::size_t>{0, 1, 2, 3, 50}) {
        const Signal phi = random.signal(size, 5);
        const Signal psi = random.signal(size, 5);
        Signal most(size);
        Signal least(size);
        Signal until(size);
        rtamt::discrete::scan<rtamt::Max>(phi, most);
        rtamt::discrete::scan<rtamt::Min>(phi, least);
        rtamt::discrete::scan_until(phi, psi, until);
        for (std::size_t t = 0; t < size; ++t) {
            double eventually = -inf;
            double always = inf;
            double best = -inf;
            for (std::size_t later = t; later < size; ++later) {
                best = std::max(best, std::min(psi[later], always)); // phi on [t, later)
                eventually = std::max(eventually, phi[later]);
                always = std::min(always, phi[later]);
            }
            CHECK(most[t] == eventually && least[t] == always && until[t] == best);
        }
    }
}

TEST(phi_is_not_required_where_psi_holds) {
    const Signal phi{-1, -1, -1};
    const Signal psi{3, 3, 3};
    Signal until(3);
    rtamt::discrete::scan_until(phi, psi, until);
    CHECK((until == Signal{3, 3, 3}));
}
