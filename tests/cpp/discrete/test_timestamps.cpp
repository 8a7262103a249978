#include "discrete/timestamps.hpp"

#include "check.hpp"

#include <cmath>
#include <vector>

using rtamt::discrete::Timestamps;

static std::vector<double> last(const Timestamps& timestamps, std::size_t count) {
    std::vector<double> times(count);
    timestamps.copy(count, times.data());
    return times;
}

// Adds the times one by one; what is read on the way is what was added last.
static void check_all(Timestamps& timestamps, const std::vector<double>& times, std::size_t size) {
    for (std::size_t i = 0; i < times.size(); ++i) {
        timestamps.add(times[i]);
        CHECK((timestamps.count() == i + 1 && timestamps.last() == times[i]));
        CHECK(timestamps.available() == std::min(i + 1, size));
        for (std::size_t count = 0; count <= timestamps.available(); ++count) {
            const auto end = times.begin() + static_cast<std::ptrdiff_t>(i + 1);
            CHECK(last(timestamps, count) ==
                  std::vector<double>(end - static_cast<std::ptrdiff_t>(count), end));
        }
    }
}

TEST_CASE("the last times come back oldest first wherever they stop being regular") {
    for (std::size_t size = 1; size <= 7; ++size) {
        Timestamps timestamps(0.1, size);
        for (std::size_t irregular = 1; irregular <= 20; ++irregular) {
            std::vector<double> times;
            for (std::size_t i = 0; i < 20; ++i) {
                const double late = i >= irregular ? 0.03 : 0.0;
                times.push_back(5.0 + static_cast<double>(i) * 0.1 + late);
            }
            check_all(timestamps, times, size);
            CHECK(timestamps.regular() == (irregular == 20));
            CHECK(timestamps.bytes() == (timestamps.regular() ? 0 : 8 * size));
            timestamps.reset();
            CHECK((timestamps.count() == 0 && timestamps.available() == 0 && !timestamps.last()));
        }
    }
}

TEST_CASE("regular times are exactly those that were given") {
    Timestamps timestamps(0.1, 3);
    for (int i = 0; i < 1000; ++i)
        timestamps.add(i * 0.1);
    CHECK((timestamps.regular() && timestamps.regular_at(1000) == 1000 * 0.1));
    CHECK((last(timestamps, 3) == std::vector<double>{997 * 0.1, 998 * 0.1, 999 * 0.1}));
}

TEST_CASE("times that were summed up drift and are kept as they are") {
    Timestamps timestamps(0.1, 4);
    std::vector<double> times{0.0};
    for (int i = 0; i < 50; ++i)
        times.push_back(times.back() + 0.1);
    check_all(timestamps, times, 4);
    CHECK(!timestamps.regular());
}
