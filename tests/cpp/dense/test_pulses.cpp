#include "dense/pulses.hpp"

#include "programs.hpp"
#include "ways.hpp"

using dense_oracle::inf;
using programs::Builder;
using rtamt::Opcode;
using ways::Executor;
using ways::Random;
using ways::Signal;

TEST_CASE("the number of pulses in a window is its definition for any width lag and chunks") {
    Random random(6);
    for (int round = 0; round < 150; ++round) {
        Builder builder;
        const auto a = builder.input();
        const std::int64_t behind = random.between(0, 4);
        const auto late = builder.later(a, behind);
        const std::int64_t width = random.between(0, 12);
        builder.output(builder.unary(Opcode::slide_sum, late, width, behind));
        builder.output(builder.unary(Opcode::slide_sum, late, width, 0)); // from the start on
        builder.output(builder.unary(Opcode::run_sum, late, 0, behind + 2));
        ways::check_all_ways(builder.program(), dense_oracle::random_trace(random, 1, 30), random,
                             "width " + std::to_string(width));
    }
}

TEST_CASE("pulses of a tick are counted and longer ones are infinitely many") {
    Builder builder;
    builder.output(builder.unary(Opcode::slide_sum, builder.input(), 3, 0));
    std::vector<Signal> outputs;
    const Signal pulses{{0, 2, 3, 5, 6, 20, 23, 30}, {0, 1, 0, 1, 0, 1, 0, 0}};
    CHECK(!ways::offline(builder.program(), {pulses}, outputs));
    CHECK((outputs[0] == Signal{{0, 2, 5, 6, 9, 20, 21, 25, 26}, {0, 1, 2, 1, 0, 1, inf, 1, 0}}));
}

TEST_CASE("a window of one tick never meets several") {
    Builder builder;
    builder.output(builder.unary(Opcode::slide_sum, builder.input(), 0, 0));
    std::vector<Signal> outputs;
    CHECK(!ways::offline(builder.program(), {{{0, 2, 9, 12}, {0, 1, 0, 0}}}, outputs));
    CHECK((outputs[0] == Signal{{0, 2, 9}, {0, 1, 0}}));
}
