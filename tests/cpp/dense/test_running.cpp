#include "dense/running.hpp"

#include "programs.hpp"
#include "ways.hpp"

using programs::Builder;
using rtamt::Opcode;
using ways::Random;

TEST_CASE("extremum so far is its definition for any lag and chunks") {
    Random random(2);
    for (int round = 0; round < 100; ++round) {
        Builder builder;
        const auto late = builder.later(builder.input(), random.between(0, 4));
        const std::int64_t lag = builder.lag(late);
        for (const Opcode opcode : {Opcode::run_max, Opcode::run_min}) {
            builder.output(builder.unary(opcode, late, 0, lag));
            builder.output(builder.unary(opcode, late, 0, lag + 5));
        }
        ways::check_all_ways(builder.program(), dense_oracle::random_trace(random, 1, 30), random,
                             "round " + std::to_string(round));
    }
}
