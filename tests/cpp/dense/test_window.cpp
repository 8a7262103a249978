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

TEST(extremum_is_its_definition_for_any_width_lag_and_chunks) {
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

TEST(long_traces_are_cut_into_steps_that_nobody_sees) {
    Random random(6);
    for (const std::int64_t width : {0, 7, 3000}) {
        Builder builder;
        builder.output(builder.unary(Opcode::slide_min, builder.input(), width, width));
        ways::check_all_ways(builder.program(), {dense_oracle::random_signal(random, 0, 900)},
                             random, "width " + std::to_string(width));
    }
}

TEST(an_arrival_and_an_expiry_at_the_same_instant_are_one_event) {
    Builder builder;
    builder.output(builder.unary(Opcode::slide_max, builder.input(), 5, 0));
    std::vector<Signal> outputs;
    CHECK(!ways::offline(builder.program(), {{{0, 1, 6, 20}, {9, 1, 4, 4}}}, outputs));
    CHECK((outputs[0] == Signal{{0, 6}, {9, 4}}));
}

TEST(exact_ticks_at_stamps_of_nanoseconds_since_1970) {
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

TEST(a_window_longer_than_time_itself_never_forgets) {
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

TEST(memory_follows_the_events_within_the_window) {
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
