#include "discrete/clock.hpp"

#include "check.hpp"

#include <cmath>
#include <limits>
#include <vector>

using rtamt::discrete::Clock;

static constexpr double inf = std::numeric_limits<double>::infinity();
static constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

TEST_CASE("time must be finite and grow") {
    Clock clock(1.0, inf, true, 1);
    CHECK(!clock.timestamps().last());
    CHECK((!clock.accepts(not_a_number) && !clock.accepts(inf) && !clock.accepts(-inf)));
    CHECK(clock.accepts(-7.5));
    clock.advance(-7.5);
    CHECK(clock.timestamps().last() == -7.5);
    CHECK((!clock.accepts(-7.5) && !clock.accepts(-8.0) && !clock.accepts(not_a_number)));
    CHECK((clock.accepts(-7.0) && clock.accepts(1e9)));
}

TEST_CASE("strict clock refuses a gap out of tolerance") {
    Clock clock(2.0, 0.25, true, 1);
    clock.advance(10.0);
    CHECK(!clock.accepts(11.25));
    CHECK((clock.accepts(11.5) && clock.accepts(12.0) && clock.accepts(12.5)));
    CHECK(!clock.accepts(12.75));
    CHECK(clock.violations() == 0);
}

TEST_CASE("lenient clock counts a gap out of tolerance") {
    Clock clock(2.0, 0.25, false, 1);
    for (const double time : {10.0, 12.0, 17.0, 17.5, 19.5}) {
        CHECK(clock.accepts(time));
        clock.advance(time);
    }
    CHECK(clock.violations() == 2);
    clock.reset();
    CHECK((clock.violations() == 0 && !clock.timestamps().last()));
    CHECK(clock.accepts(0.0));
}

TEST_CASE("lenient clock takes the same time again and counts it") {
    Clock clock(2.0, 0.25, false, 2);
    clock.advance(10.0);
    CHECK((clock.accepts(10.0) && !clock.accepts(9.5)));
    clock.advance(10.0);
    CHECK(clock.violations() == 1);
    CHECK((clock.timestamps().count() == 2 && clock.timestamps().last() == 10.0));
    Clock strict(2.0, 2.0, true, 1);
    strict.advance(10.0);
    CHECK(!strict.accepts(10.0));
}

TEST_CASE("ticks start at zero and do not drift") {
    Clock clock(0.1, 0.5, true, 1);
    clock.tick(1);
    CHECK(clock.timestamps().last() == 0.0);
    for (int i = 0; i < 100000; ++i)
        clock.tick(1);
    CHECK(clock.timestamps().last() == 100000 * 0.1);
    clock.tick(0);
    CHECK(clock.timestamps().last() == 100000 * 0.1);
    clock.advance(10000.13);
    clock.tick(5);
    CHECK(clock.timestamps().last() == 10000.13 + 5 * 0.1);
}

TEST_CASE("ticks after regular times go on from the first of them") {
    Clock clock(0.1, 0.5, true, 1);
    for (int i = 0; i < 7; ++i)
        clock.advance(3.0 + i * 0.1);
    clock.tick(3);
    CHECK((clock.timestamps().last() == 3.0 + 9 * 0.1 && clock.timestamps().regular()));
}

TEST_CASE("a copy tells the same times and goes on alike") {
    for (const std::size_t irregular : {std::size_t{0}, std::size_t{3}, std::size_t{9}}) {
        Clock clock(1.0, 0.1, false, 4);
        for (std::size_t i = 0; i < 9; ++i)
            clock.advance(static_cast<double>(i) + (i >= irregular ? 0.25 : 0.0));
        rtamt::Snapshot written;
        clock.transfer(written);
        Clock twin(1.0, 0.1, false, 4);
        rtamt::Snapshot read(written.bytes());
        twin.transfer(read);
        read.end();
        clock.tick(2);
        twin.tick(2);
        std::vector<double> times(4);
        std::vector<double> others(4);
        clock.timestamps().copy(4, times.data());
        twin.timestamps().copy(4, others.data());
        CHECK((times == others && twin.violations() == clock.violations()));
    }
}

TEST_CASE("ticks of many samples are as many ticks") {
    Clock clock(0.5, 0.5, true, 4);
    clock.tick(4);
    std::vector<double> times(4);
    clock.timestamps().copy(4, times.data());
    CHECK((times == std::vector<double>{0.0, 0.5, 1.0, 1.5}));
    clock.reset();
    clock.tick(1);
    CHECK(clock.timestamps().last() == 0.0);
}
