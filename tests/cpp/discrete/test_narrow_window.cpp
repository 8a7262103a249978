#include "discrete/narrow_window.hpp"

#include "check.hpp"
#include "oracle.hpp"
#include "values/algebra.hpp"

using rtamt::Max;
using rtamt::Min;
using rtamt::discrete::NarrowWindow;

namespace {

template <class Algebra>
void check_window(std::size_t width, std::size_t count, oracle::Random& random) {
    const oracle::Signal signal = random.signal(width - 1 + count);
    NarrowWindow<Algebra> window(width);
    std::copy_n(signal.data(), width - 1, window.before());
    oracle::Signal results(count);
    window.run(signal.data() + (width - 1), results.data(), count);
    oracle::Signal expected;
    for (std::size_t i = 0; i < count; ++i) {
        double total = Algebra::identity;
        for (std::size_t k = i; k < i + width; ++k)
            total = Algebra::join(signal[k], total);
        expected.push_back(total);
    }
    CHECK_MESSAGE(results == expected,
                  ("width " + std::to_string(width) + ", count " + std::to_string(count)));
}

} // namespace

TEST_CASE("narrow window is its definition for every width and runs of any length") {
    oracle::Random random(1);
    for (std::size_t width = 1; width <= NarrowWindow<Max>::widest; ++width) {
        for (const std::size_t more : {0U, 1U, 3U, 200U, 600U}) {
            check_window<Max>(width, width + more, random);
            check_window<Min>(width, width + more, random);
        }
    }
}
