#include "early/window_sums.hpp"

#include "check.hpp"
#include "discrete/oracle.hpp"

#include <algorithm>
#include <vector>

using rtamt::Bounds;
using rtamt::early::Tick;
using rtamt::early::WindowSums;

namespace {

// The window that ends at a tick: the end of one block, backwards, and the begin of the next.
Bounds total(const std::vector<Bounds>& x, Tick end, Tick width) {
    const Tick block = end / width * width;
    Bounds ending{0, 0};
    Bounds beginning{0, 0};
    for (Tick t = block; t <= end; ++t) {
        const Bounds& each = x[static_cast<std::size_t>(t)];
        beginning = {beginning.lower + each.lower, beginning.upper + each.upper};
    }
    for (Tick t = block; t > std::max<Tick>(end + 1 - width, 0); --t) {
        const Bounds& each = x[static_cast<std::size_t>(t - 1)];
        ending = {ending.lower + each.lower, ending.upper + each.upper};
    }
    return {ending.lower + beginning.lower, ending.upper + beginning.upper};
}

} // namespace

TEST_CASE("sums are sums of bounds in the order of the definition whatever is read and changes") {
    oracle::Random random(9);
    for (const Tick width : {1, 2, 3, 7, 8, 30, 100}) {
        std::vector<Bounds> x;
        for (int i = 0; i < 60; ++i) {
            const double value = random.number(0) / 3;
            x.push_back({value, value + static_cast<double>(random.between(0, 2)) / 7});
        }
        WindowSums sums(width);
        for (int i = 0; i < 400; ++i) {
            if (random.chance(20)) {
                const auto at = random.between(0, 59);
                x[static_cast<std::size_t>(at)].upper += 0.1;
                sums.change(at, at);
            }
            const Tick end = random.chance(50) ? Tick{i % 60} : random.between(0, 59);
            const auto read = [&](Tick t) { return x[static_cast<std::size_t>(t)]; };
            CHECK((sums.at(end, read) == total(x, end, width)));
        }
    }
}

TEST_CASE("a window that may be anywhere has the hull of its sums") {
    const std::vector<Bounds> x(100, Bounds{0.1, 0.3});
    WindowSums sums(10);
    const Bounds hull = sums.anywhere(x[0]);
    Bounds found = total(x, 9, 10);
    for (Tick end = 10; end < 20; ++end) {
        const Bounds each = total(x, end, 10);
        found = {std::min(found.lower, each.lower), std::max(found.upper, each.upper)};
    }
    CHECK((hull == found));
    WindowSums wide(1'000'000);
    CHECK((wide.anywhere({0.1, 0.3}).lower < 1e5 && wide.anywhere({0.1, 0.3}).upper > 3e5));
    CHECK((wide.anywhere({-0.1, 0}).upper == 0));
}
