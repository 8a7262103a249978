#include "dense/constant.hpp"

#include "programs.hpp"
#include "ways.hpp"

using dense_oracle::inf;
using programs::Builder;
using rtamt::Opcode;
using ways::Random;
using ways::Signal;

TEST_CASE("a constant is one event where it begins") {
    rtamt::dense::Constant<rtamt::Real> constant(3, 2.5);
    constant.begin(100);
    CHECK((constant.run(102) == rtamt::dense::never && constant.out().count == 0));
    CHECK(constant.run(200) == rtamt::dense::never);
    CHECK((dense_oracle::signal_of(constant.out()) == Signal{{103}, {2.5}}));
    CHECK((constant.run(300) == rtamt::dense::never && constant.out().count == 0));
}

TEST_CASE("constants are there wherever they are read") {
    Random random(11);
    Builder builder;
    const auto three = builder.constant(3);
    const auto a = builder.input();
    const auto late = builder.later(a, 4);
    builder.output(three);
    builder.output(builder.pointwise(Opcode::min, three, late));
    builder.output(builder.pointwise(Opcode::min, a, three));
    builder.output(builder.unary(Opcode::shift, three, 2, 0, -inf));
    builder.output(builder.unary(Opcode::slide_max, three, 2, 3));
    builder.output(builder.binary(Opcode::until, three, late, 2, 6));
    builder.output(builder.pointwise(Opcode::add, three, three));
    for (int round = 0; round < 30; ++round) {
        ways::check_all_ways(builder.program(), dense_oracle::random_trace(random, 1, 20), random,
                             "round " + std::to_string(round));
    }
}
