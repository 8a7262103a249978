#include "dense/window.hpp"

#include "programs.hpp"
#include "ways.hpp"

using dense_oracle::inf;
using programs::Builder;
using rtamt::Opcode;
using ways::EventList;
using ways::Events;
using ways::Executor;
using ways::Random;
using ways::Signal;

TEST_CASE("extremum is its definition for any width lag and chunks") {
    Random random(5);
    for (int round = 0; round < 60; ++round) {
        for (const std::int64_t width : {0, 1, 2, 3, 5, 9, 40, 200}) {
            Builder builder;
            const auto late = builder.later(builder.input(), random.between(0, 5));
            const std::int64_t head = builder.lag(late);
            for (const Opcode opcode : {Opcode::slide_max, Opcode::slide_min}) {
                for (const std::int64_t lag : {head, head + width, head + width + 5}) {
                    builder.output(builder.unary(opcode, late, width, lag));
                }
                builder.output(builder.unary(opcode, late, width, 0));
            }
            ways::check_all_ways(builder.program(), dense_oracle::random_trace(random, 1, 30),
                                 random, "width " + std::to_string(width));
        }
    }
}

TEST_CASE("long traces are cut into steps without changing the result") {
    Random random(6);
    for (const std::int64_t width : {0, 7, 3000}) {
        Builder builder;
        builder.output(builder.unary(Opcode::slide_min, builder.input(), width, width));
        ways::check_all_ways(builder.program(), {dense_oracle::random_signal(random, 0, 900)},
                             random, "width " + std::to_string(width));
    }
}

TEST_CASE("an arrival and an expiry at the same instant are one event") {
    Builder builder;
    builder.output(builder.unary(Opcode::slide_max, builder.input(), 5, 0));
    std::vector<Signal> outputs;
    CHECK(!ways::offline(builder.program(), {{{0, 1, 6, 20}, {9, 1, 4, 4}}}, outputs));
    CHECK((outputs[0] == Signal{{0, 6}, {9, 4}}));
}

TEST_CASE("exact ticks at timestamps of nanoseconds since 1970") {
    constexpr std::int64_t base = 1'700'000'000'000'000'000;
    Builder builder;
    builder.output(builder.unary(Opcode::slide_max, builder.input(), 100'000'000, 100'000'000));
    std::vector<Signal> outputs;
    CHECK(!ways::offline(
        builder.program(),
        {{{base, base + 200'000'000, base + 200'000'001, base + 900'000'000}, {0, 7, 0, 0}}},
        outputs));
    CHECK((outputs[0] == Signal{{base, base + 100'000'000, base + 200'000'001}, {0, 7, 0}}));
}

TEST_CASE("a window longer than time itself never forgets") {
    Builder builder;
    builder.output(builder.unary(Opcode::slide_max, builder.input(), rtamt::longest_dense, 0));
    constexpr std::int64_t base = 9'000'000'000'000'000'000;
    std::vector<Signal> outputs;
    CHECK(!ways::offline(builder.program(), {{{-base, base, base + 5}, {3, 2, 4}}}, outputs));
    // The window of 2^62 ticks ends in between, and not after the last tick.
    CHECK((outputs[0] == Signal{{-base, base, base + 5}, {3, 3, 4}}.merged()));
    CHECK(!ways::offline(builder.program(), {{{base, base + 5, base + 9}, {3, 2, 1}}}, outputs, 7));
    CHECK((outputs[0] == Signal{{base}, {3}}));
}

TEST_CASE("memory follows the events within the window") {
    Builder builder;
    const auto a = builder.input();
    builder.output(builder.unary(Opcode::slide_max, a, 1000, 0));
    builder.output(builder.unary(Opcode::slide_min, a, 1000, 0));
    Executor executor(builder.program());
    std::vector<EventList> outputs(2);
    for (std::int64_t t = 0; t < 200000; ++t) {
        const std::int64_t time = 100 * t;
        const double value = -static_cast<double>(t);
        const std::vector<Events> inputs{{&time, &value, 1}};
        CHECK(!executor.push(inputs, outputs));
    }
    CHECK(executor.state_bytes() < 2000);
}
