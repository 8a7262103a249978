#include "discrete/journal.hpp"

#include "check.hpp"

#include <array>

TEST_CASE("restores exactly the saved cells") {
    std::array<double, 6> ring{0, 1, 2, 3, 4, 5};
    std::array<double, 6> store{};
    rtamt::discrete::Journal journal(store.data());
    journal.save(ring.data(), 2, 3);
    ring = {10, 11, 12, 13, 14, 15};
    journal.restore(ring.data());
    CHECK((ring == std::array<double, 6>{10, 11, 2, 3, 4, 15}));
}

TEST_CASE("saving nothing restores nothing") {
    std::array<double, 2> ring{1, 2};
    rtamt::discrete::Journal<double> journal(nullptr);
    journal.save(ring.data(), 2, 0);
    ring = {3, 4};
    journal.restore(ring.data());
    CHECK((ring == std::array<double, 2>{3, 4}));
}
