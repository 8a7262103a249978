#include "dense/pointwise.hpp"

#include "programs.hpp"
#include "ways.hpp"

using dense_oracle::inf;
using programs::Builder;
using rtamt::Opcode;
using ways::Random;
using ways::Signal;

TEST_CASE("every function is its definition at every instant") {
    Random random(1);
    for (int round = 0; round < 60; ++round) {
        for (const Opcode opcode :
             {Opcode::neg, Opcode::abs, Opcode::exp, Opcode::add, Opcode::sub, Opcode::mul,
              Opcode::min, Opcode::max, Opcode::holds_gt, Opcode::holds_ge, Opcode::holds_eq,
              Opcode::atan2, Opcode::hypot, Opcode::floor, Opcode::round, Opcode::sign}) {
            Builder builder;
            const auto a = builder.input();
            const auto b = builder.input();
            const auto c = builder.constant(random.number(0));
            const bool two = rtamt::info(opcode).operands == 2;
            builder.output(builder.pointwise(opcode, a, two ? b : rtamt::no_operand));
            if (two) {
                builder.output(builder.pointwise(opcode, b, c));
                builder.output(builder.pointwise(opcode, c, a));
                builder.output(builder.pointwise(opcode, a, a));
                builder.output(builder.pointwise(opcode, builder.later(a, 3), c));
            }
            const auto trace = dense_oracle::random_trace(random, 2, 25, 0, 0);
            ways::check_all_ways(builder.program(), trace, random,
                                 std::string(rtamt::info(opcode).name));
        }
    }
}

TEST_CASE("a result that does not change is one event") {
    Builder builder;
    const auto a = builder.input();
    const auto b = builder.input();
    builder.output(builder.pointwise(Opcode::max, a, b));
    std::vector<Signal> outputs;
    CHECK(!ways::offline(builder.program(), {{{0, 2, 5, 7}, {1, 2, 3, 9}}, {{1, 5}, {4, 4}}},
                         outputs));
    CHECK((outputs[0] == Signal{{1, 7}, {4, 9}}));
}

TEST_CASE("zeros of both signs are one value") {
    Builder builder;
    const auto negated = builder.pointwise(Opcode::neg, builder.input());
    builder.output(negated);
    builder.output(builder.pointwise(Opcode::div, builder.constant(1), negated));
    std::vector<Signal> outputs;
    CHECK(!ways::offline(builder.program(), {{{0, 1, 2}, {0.0, -0.0, 1.0}}}, outputs));
    CHECK((outputs[0] == Signal{{0, 2}, {0.0, -1.0}}));
    CHECK((outputs[1] == Signal{{0, 2}, {inf, -1.0}}));
}

TEST_CASE("the first result that is nan is the failure") {
    Builder builder;
    const auto root = builder.pointwise(Opcode::sqrt, builder.later(builder.input(), 4));
    builder.output(root);
    std::vector<Signal> outputs;
    const auto failure =
        ways::offline(builder.program(), {{{-3, 0, 2, 7}, {1.0, 4.0, -1.0, -2.0}}}, outputs);
    CHECK((failure && failure->instruction == root && failure->time == 2));
}
