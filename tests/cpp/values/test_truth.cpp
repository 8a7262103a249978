#include "values/truth.hpp"

#include "laws.hpp"
#include "values/functions.hpp"

using rtamt::Truth;

TEST_CASE("words are a lattice") {
    laws::check_lattice<Truth>();
}

TEST_CASE("bit k is the truth of trace k") {
    oracle::Random random(3);
    for (int i = 0; i < 200; ++i) {
        const auto a = laws::Sampler<Truth::Number>::one(random);
        const auto b = laws::Sampler<Truth::Number>::one(random);
        for (std::size_t k = 0; k < Truth::traces; ++k) {
            const auto bit = [&](std::uint64_t word) { return ((word >> k) & 1U) != 0; };
            using namespace rtamt::functions;
            CHECK(bit(Truth::test<HoldsGreater>(a, b)) == (a.lane[k] > b.lane[k]));
            CHECK(bit(Truth::test<HoldsGreaterEqual>(a, b)) == (a.lane[k] >= b.lane[k]));
            CHECK(bit(Truth::test<HoldsEqual>(a, b)) == (a.lane[k] == b.lane[k]));
            CHECK(bit(Truth::formula(a)) == (a.lane[k] > 0));
        }
    }
}

TEST_CASE("a formula as a number is infinite and comes back unchanged") {
    oracle::Random random(4);
    for (int i = 0; i < 200; ++i) {
        const auto word = laws::Sampler<Truth>::one(random);
        const auto number = Truth::number(word);
        for (const double lane : number.lane)
            CHECK((lane == oracle::inf || lane == -oracle::inf));
        CHECK(Truth::formula(number) == word);
    }
}
