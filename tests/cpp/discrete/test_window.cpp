#include "discrete/window.hpp"

#include "programs.hpp"
#include "ways.hpp"

using oracle::inf;
using programs::Builder;
using rtamt::infinity;
using rtamt::Joined;
using rtamt::Max;
using rtamt::Min;
using rtamt::Opcode;
using rtamt::discrete::TwoStack;
using ways::Executor;
using ways::Random;
using ways::Signal;

TEST_CASE("extremum is its definition for any width lag and chunks") {
    Random random(5);
    for (const std::size_t count : std::initializer_list<std::size_t>{0, 1, 2, 10, 257, 700}) {
        const std::vector<Signal> columns{random.signal(count)};
        for (const std::int64_t width : {1, 2, 3, 4, 5, 6, 7, 8, 9, 17, 100, 255, 256, 257, 800}) {
            for (const std::int64_t head : {0, 3, 270}) {
                Builder builder;
                const auto late = builder.later(builder.input(), head);
                for (const Opcode opcode : {Opcode::slide_max, Opcode::slide_min}) {
                    for (const std::int64_t lag :
                         {head, head + width - 1, head + width + 5, std::int64_t{0}}) {
                        builder.output(builder.unary(opcode, late, width, lag));
                    }
                }
                ways::check_all_ways(builder.program(), columns, count, random,
                                     "width " + std::to_string(width) + ", head " +
                                         std::to_string(head) + ", count " + std::to_string(count));
            }
        }
    }
}

TEST_CASE("sum is its definition to the bit for any width and chunks") {
    Random random(6);
    for (const std::size_t count : std::initializer_list<std::size_t>{0, 1, 2, 10, 257, 700}) {
        std::vector<Signal> columns{random.signal(count, 0)};
        for (double& value : columns[0])
            value = value / 7 + 1e9 * (value > 0); // such that the order of additions shows
        for (const std::int64_t width : {1, 2, 3, 4, 7, 8, 17, 100, 255, 256, 257, 800}) {
            Builder builder;
            const auto x = builder.input();
            for (const std::int64_t behind : {0, 3, 270}) { // windows of the past alone
                const auto late = builder.later(x, behind);
                builder.output(builder.unary(Opcode::slide_sum, late, width, 0));
                builder.output(builder.unary(Opcode::run_sum, late, 0, 0));
            }
            ways::check_all_ways(builder.program(), columns, count, random,
                                 "width " + std::to_string(width) + ", count " +
                                     std::to_string(count));
        }
    }
}

TEST_CASE("sum fails only while both infinities are in the window") {
    Builder builder;
    builder.output(builder.unary(Opcode::slide_sum, builder.input(), 3, 0));
    std::vector<Signal> outputs;
    CHECK(!ways::offline(builder.program(), {{1, inf, 3, 4, -inf, 0, 0, 1}}, 8, outputs));
    CHECK((outputs[0] == Signal{1, inf, inf, inf, -inf, -inf, -inf, 1}));
    const auto failure = ways::offline(builder.program(), {{1, inf, 3, -inf, 4}}, 5, outputs);
    CHECK((failure && failure->instruction == 1 && failure->sample == 3));
}

TEST_CASE("sum of a window that lies later than the last sample may be undefined") {
    Builder builder;
    const auto late = builder.later(builder.input(), 1);
    builder.output(builder.unary(Opcode::slide_sum, late, 2, 0));
    builder.output(builder.later(late, 3)); // so that the last value comes later
    std::vector<Signal> outputs;
    CHECK(!ways::offline(builder.program(), {{0.5, -inf, inf}}, 3, outputs));
    CHECK((outputs[0] == Signal{0, 0.5, -inf}));
    const auto failure = ways::offline(builder.program(), {{0.5, -inf, inf, 1}}, 4, outputs);
    CHECK((failure && failure->instruction == 2 && failure->sample == 3));
}

TEST_CASE("window of a constant is cut at the ends of the trace") {
    Builder builder;
    const auto three = builder.constant(3.0);
    builder.input();
    builder.output(builder.unary(Opcode::slide_max, three, 2, 3)); // eventually[2,3]
    std::vector<Signal> outputs;
    CHECK(!ways::offline(builder.program(), {Signal(5, 0.0)}, 5, outputs));
    CHECK((outputs[0] == Signal{3, 3, 3, -inf, -inf}));
}

TEST_CASE("historically eventually reads nothing from before the horizon") {
    // historically(eventually[0,2] x) on 0,0,5,5,5,5,5 is 5 everywhere.
    Builder builder;
    const auto eventually = builder.unary(Opcode::slide_max, builder.input(), 3, 2);
    builder.output(builder.unary(Opcode::run_min, eventually, 0, 2));
    std::vector<Signal> outputs;
    CHECK(!ways::offline(builder.program(), {{0, 0, 5, 5, 5, 5, 5}}, 7, outputs));
    CHECK((outputs[0] == Signal(7, 5.0)));
}

TEST_CASE("a wide window costs one double a sample of it") {
    Builder builder;
    builder.output(builder.unary(Opcode::slide_max, builder.input(), 1000000, 0));
    Executor executor(builder.program());
    CHECK(executor.state_bytes() < 8 * 1000000 + 100);
}

namespace {

// NaN fails every comparison, zeros are equal: what a window of reals may hold but NaN.
double extreme(oracle::Random& random) {
    if (random.chance(10)) return random.chance(50) ? -0.0 : 0.0;
    if (random.chance(10)) return random.chance(50) ? infinity : -infinity;
    return static_cast<double>(random.between(-50, 50)) / 2.0;
}

template <class Algebra>
void check_extrema(std::size_t width, oracle::Random& random) {
    const std::size_t count = random.chance(20) ? width / 2 + 1 : 2 * width + 700;
    std::vector<double> values(count);
    for (double& value : values)
        value = extreme(random);
    std::vector<double> ring(width);
    std::vector<double> journal(width);
    TwoStack<Joined<Algebra>> stack(width, ring.data(), journal.data());
    std::vector<double> results(count);
    for (std::size_t i = 0; i < count;) {
        const int longest = random.chance(50) ? 300 : 3;
        const auto part = std::min(count - i, static_cast<std::size_t>(random.between(1, longest)));
        if (random.chance(30)) { // taken back
            const std::vector<double> others(part, random.chance(50) ? -infinity : infinity);
            stack.checkpoint(part);
            stack.push({others.data(), nullptr}, results.data() + i, part);
            stack.rollback();
        }
        stack.push({values.data() + i, nullptr}, results.data() + i, part);
        i += part;
    }
    for (std::size_t i = 0; i < count; ++i) {
        double expected = Algebra::identity;
        for (std::size_t k = i + 1 - std::min(i + 1, width); k <= i; ++k)
            expected = Algebra::join(values[k], expected);
        if (results[i] != expected) {
            FAIL_CHECK("width " << width << ", sample " << i << ": " << results[i] << ", not "
                                << expected);
            return;
        }
    }
}

} // namespace

// Narrow windows over long runs, wide ones in vectors, and the loops between.
TEST_CASE("extremum of reals is its definition for every width at which the loops change") {
    oracle::Random random(3);
    std::vector<std::size_t> widths{63, 64, 65, 66, 67, 68, 100, 255, 256, 257, 999, 1000, 1001};
    for (std::size_t width = 1; width <= 40; ++width)
        widths.push_back(width);
    for (const std::size_t width : widths) {
        for (int round = 0; round < 4; ++round) {
            check_extrema<Max>(width, random);
            check_extrema<Min>(width, random);
        }
    }
}
