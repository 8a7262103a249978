#include "discrete/kernel.hpp"

#include "check.hpp"
#include "program/program.hpp"

using rtamt::discrete::Block;
using rtamt::discrete::endless;
using rtamt::discrete::Range;

TEST_CASE("present is where the time is a sample of the trace") {
    for (std::int64_t samples = 0; samples <= 6; ++samples) {
        for (std::int64_t lag = 0; lag <= 6; ++lag) {
            for (std::int64_t slot = 0; slot <= 14; ++slot) {
                const Block block{slot, 5, samples};
                const Range range = block.present(lag);
                CHECK((range.begin <= range.end && range.end <= block.count));
                for (std::size_t i = 0; i < block.count; ++i) {
                    const std::int64_t time = slot + static_cast<std::int64_t>(i) - lag;
                    const bool present = time >= 0 && time < samples;
                    CHECK(present == (range.begin <= i && i < range.end));
                }
            }
        }
    }
}

TEST_CASE("a trace without end is present from its lag on") {
    const Range range = Block{endless / 2, 256, endless}.present(rtamt::longest);
    CHECK((range.begin == 0 && range.end == 256));
    const Range head = Block{0, 256, endless}.present(200);
    CHECK((head.begin == 200 && head.end == 256));
}
