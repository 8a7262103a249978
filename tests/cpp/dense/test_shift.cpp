#include "dense/shift.hpp"

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

TEST_CASE("shift is its definition for any distance lag and chunks") {
    Random random(4);
    for (int round = 0; round < 150; ++round) {
        Builder builder;
        const auto a = builder.input();
        const auto late = builder.later(a, random.between(0, 3));
        const std::int64_t distance = random.between(0, 15);
        const std::int64_t lag = builder.lag(late);
        builder.output(builder.unary(Opcode::shift, late, distance, lag, -inf));
        builder.output(builder.unary(Opcode::shift, late, distance, lag + distance, inf));
        builder.output(builder.unary(Opcode::shift, late, distance, lag + 2, 3.0));
        builder.output(builder.unary(Opcode::shift, late, 0, lag + distance, 3.0));
        ways::check_all_ways(builder.program(), dense_oracle::random_trace(random, 1, 30), random,
                             "distance " + std::to_string(distance));
    }
}

TEST_CASE("what moves beyond the last tick never happens") {
    Builder builder;
    const auto a = builder.input();
    builder.output(builder.unary(Opcode::shift, a, rtamt::longest_dense, 0, 0.5));
    const std::int64_t late = rtamt::dense::never - 10;
    std::vector<Signal> outputs;
    CHECK(!ways::offline(builder.program(), {{{late, late + 3}, {1, 2}}}, outputs));
    CHECK((outputs[0] == Signal{{late}, {0.5}}));
}

TEST_CASE("memory follows the events within the distance") {
    Builder builder;
    builder.output(builder.unary(Opcode::shift, builder.input(), 1000, 0, 0));
    Executor executor(builder.program());
    std::vector<EventList> outputs(1);
    for (std::int64_t t = 0; t < 200000; ++t) {
        const std::int64_t time = 100 * t;
        const auto value = static_cast<double>(t % 7);
        const std::vector<Events> inputs{{&time, &value, 1}};
        CHECK(!executor.push(inputs, outputs));
    }
    CHECK(outputs[0].count() > 190000);
    CHECK(executor.state_bytes() < 1000);
}
