#include "dense/until.hpp"

#include "programs.hpp"
#include "ways.hpp"

using programs::Builder;
using rtamt::Opcode;
using ways::EventList;
using ways::Events;
using ways::Executor;
using ways::Random;
using ways::Signal;

TEST_CASE("until is its definition for any width lag and chunks") {
    Random random(7);
    for (int round = 0; round < 80; ++round) {
        for (const std::int64_t width : {0, 1, 2, 4, 11, 60}) {
            Builder builder;
            const auto phi = builder.input();
            const auto psi = builder.input();
            builder.output(builder.binary(Opcode::until, phi, psi, width, 0));
            builder.output(builder.binary(Opcode::until, phi, psi, width, width));
            builder.output(builder.binary(Opcode::until, phi, psi, width, width + 3));
            builder.output(builder.binary(Opcode::until, builder.constant(2), psi, width, width));
            ways::check_all_ways(builder.program(), dense_oracle::random_trace(random, 2, 30),
                                 random, "width " + std::to_string(width));
        }
    }
}

TEST_CASE("phi is not required where psi holds") {
    Builder builder;
    const auto phi = builder.input();
    const auto psi = builder.input();
    builder.output(builder.binary(Opcode::until, phi, psi, 10, 10));
    std::vector<Signal> outputs;
    CHECK(!ways::offline(builder.program(), {{{0, 50}, {-1, -1}}, {{0, 50}, {3, 3}}}, outputs));
    CHECK((outputs[0] == Signal{{0}, {3}}));
}

TEST_CASE("until within one second sees psi jump while phi falls") {
    // (h < 0.5) until[0,1] (h >= 0.5), h 0@0 1@0.5, in milliseconds: +0.5 at 0
    Builder builder;
    const auto h = builder.input();
    const auto half = builder.constant(0.5);
    builder.output(builder.binary(Opcode::until, builder.pointwise(Opcode::sub, half, h),
                                  builder.pointwise(Opcode::sub, h, half), 1000, 1000));
    std::vector<Signal> outputs;
    CHECK(!ways::offline(builder.program(), {{{0, 500}, {0, 1}}}, outputs));
    CHECK((outputs[0] == Signal{{0}, {0.5}}));
}

TEST_CASE("memory follows the events within the window") {
    Builder builder;
    const auto a = builder.input();
    builder.output(builder.binary(Opcode::until, a, builder.pointwise(Opcode::neg, a), 1000, 1000));
    Executor executor(builder.program());
    std::vector<EventList> outputs(1);
    for (std::int64_t t = 0; t < 100000; ++t) {
        const std::int64_t time = 100 * t;
        const auto value = static_cast<double>(t % 13);
        const std::vector<Events> inputs{{&time, &value, 1}};
        CHECK(!executor.push(inputs, outputs));
    }
    CHECK(executor.state_bytes() < 3000);
}
