#include "discrete/arena.hpp"

#include "check.hpp"

#include <limits>

using rtamt::discrete::Arena;

TEST_CASE("pieces follow one another") {
    Arena arena(5 * sizeof(double));
    const auto* first = static_cast<double*>(arena.take(2 * sizeof(double)));
    auto* second = static_cast<double*>(arena.take(3 * sizeof(double)));
    CHECK(second == first + 2);
    CHECK(arena.bytes() == 40);
    second[2] = 1.0; // the sanitizer watches
    CHECK(second[2] == 1.0);
}

TEST_CASE("empty arena holds nothing") {
    Arena arena(0);
    CHECK(arena.bytes() == 0);
    CHECK(arena.take(0) == nullptr);
}

TEST_CASE("a size that overflows is bad alloc and not a small arena") {
    constexpr std::size_t most = std::numeric_limits<std::size_t>::max();
    CHECK(thrown<std::bad_alloc>([] { (void)Arena(most / 2 + 1); }) ==
          std::string(std::bad_alloc().what()));
}
