#include "discrete/shift.hpp"

#include "programs.hpp"
#include "ways.hpp"

using oracle::inf;
using programs::Builder;
using rtamt::Opcode;
using ways::Random;
using ways::Signal;

TEST_CASE("shift is its definition for any distance lag and chunks") {
    Random random(4);
    for (const std::size_t count :
         std::initializer_list<std::size_t>{0, 1, 2, 10, 255, 256, 257, 1000}) {
        const std::vector<Signal> columns{random.signal(count)};
        for (const std::int64_t distance : {0, 1, 2, 3, 9, 255, 256, 257, 600}) {
            for (const std::int64_t head : {0, 1, 4, 300}) {
                Builder builder;
                const auto late = builder.later(builder.input(), head);
                for (const std::int64_t lag : {head, head + distance, head + 2, std::int64_t{0}}) {
                    builder.output(builder.unary(Opcode::shift, late, distance, lag, 7.5));
                }
                ways::check_all_ways(builder.program(), columns, count, random,
                                     "distance " + std::to_string(distance) + ", head " +
                                         std::to_string(head) + ", count " + std::to_string(count));
            }
        }
    }
}

TEST_CASE("next yields the given value after the last sample") {
    Builder builder;
    builder.output(builder.unary(Opcode::shift, builder.input(), 0, 1, inf)); // next
    builder.output(builder.unary(Opcode::shift, 0, 1, 0, -inf));              // s_prev
    std::vector<Signal> outputs;
    CHECK(!ways::offline(builder.program(), {{1, 2, 3}}, 3, outputs));
    CHECK((outputs[0] == Signal{2, 3, inf}));
    CHECK((outputs[1] == Signal{-inf, 1, 2}));
}
