#include "discrete/running.hpp"

#include "programs.hpp"
#include "ways.hpp"

using programs::Builder;
using rtamt::Opcode;
using ways::Random;
using ways::Signal;

TEST_CASE("running extremum is its definition at any lag and in any chunks") {
    Random random(6);
    for (const std::size_t count : std::initializer_list<std::size_t>{0, 1, 2, 300, 600}) {
        const std::vector<Signal> columns{random.signal(count)};
        for (const std::int64_t head : {0, 3, 270}) {
            Builder builder;
            const auto late = builder.later(builder.input(), head);
            for (const Opcode opcode : {Opcode::run_max, Opcode::run_min}) {
                for (const std::int64_t lag : {head, head + 4, std::int64_t{0}}) {
                    builder.output(builder.unary(opcode, late, 0, lag));
                }
            }
            ways::check_all_ways(builder.program(), columns, count, random,
                                 "head " + std::to_string(head));
        }
    }
}
