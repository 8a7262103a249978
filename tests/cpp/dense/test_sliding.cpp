#include "dense/sliding.hpp"

#include "dense/window.hpp"
#include "ways.hpp"

#include <memory>

using dense_oracle::signal_of;
using rtamt::Joined;
using rtamt::Max;
using rtamt::Min;
using rtamt::Real;
using rtamt::dense::Events;
using rtamt::dense::Sliding;
using rtamt::dense::Wedge;
using ways::Random;
using ways::Signal;

namespace {

// The events of a kernel that reads a signal in stretches, which are now and then taken back first.
template <class Kernel>
Signal run(Kernel& kernel, const Signal& signal, std::int64_t end, std::uint32_t seed) {
    Random random(seed);
    Signal result;
    std::size_t taken = 0;
    for (std::int64_t frontier = 0; frontier <= end; frontier += random.between(1, 9)) {
        std::size_t count = 0;
        while (taken + count < signal.size() && signal.times[taken + count] <= frontier)
            ++count;
        const Events events = signal.events(taken, count);
        kernel.connect(&events, nullptr);
        if (random.chance(30)) {
            kernel.checkpoint();
            (void)kernel.run(frontier);
            kernel.rollback();
        }
        (void)kernel.run(frontier);
        const Signal fresh = signal_of(kernel.out());
        for (std::size_t i = 0; i < fresh.size(); ++i)
            result.add(fresh.times[i], fresh.values[i]);
        taken += count;
    }
    return result.merged();
}

template <class Algebra>
void check_windows() {
    Random random(1);
    for (int round = 0; round < 400; ++round) {
        const Signal signal = dense_oracle::random_signal(random, 0, 40);
        const std::int64_t width = random.between(0, 40);
        Wedge<Algebra> wedge(0, width);
        Sliding<Joined<Algebra>, Real> stacks(0, width);
        wedge.begin(0);
        stacks.begin(0);
        const std::int64_t end = signal.times.back() + 60;
        const auto seed = static_cast<std::uint32_t>(round);
        CHECK_MESSAGE(run(wedge, signal, end, seed) == run(stacks, signal, end, seed),
                      ("round " + std::to_string(round)));
    }
}

} // namespace

TEST_CASE("two stacks give what the wedge gives where values are ordered") {
    check_windows<Max>();
    check_windows<Min>();
}
