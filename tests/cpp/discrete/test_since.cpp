#include "discrete/since.hpp"

#include "programs.hpp"
#include "ways.hpp"

using oracle::inf;
using programs::Builder;
using rtamt::Opcode;
using ways::Random;
using ways::Signal;

TEST_CASE("since is its definition at any lag and in any chunks") {
    Random random(7);
    for (const std::size_t count : std::initializer_list<std::size_t>{0, 1, 2, 150, 300}) {
        const std::vector<Signal> columns{random.signal(count), random.signal(count)};
        for (const std::int64_t head : {0, 3, 40}) {
            Builder builder;
            const auto phi = builder.later(builder.input(), head);
            const auto psi = builder.later(builder.input(), head);
            const auto one = builder.constant(1.0);
            for (const std::int64_t lag : {head, head + 4, std::int64_t{0}}) {
                builder.output(builder.binary(Opcode::since, phi, psi, 0, lag));
                builder.output(builder.binary(Opcode::since, phi, phi, 0, lag));
                builder.output(builder.binary(Opcode::since, one, psi, 0, lag));
                builder.output(builder.binary(Opcode::since, phi, one, 0, lag));
            }
            ways::check_all_ways(builder.program(), columns, count, random,
                                 "head " + std::to_string(head));
        }
    }
}

TEST_CASE("phi is not required at the instant of psi") {
    Builder builder;
    const auto phi = builder.input();
    const auto psi = builder.input();
    builder.output(builder.binary(Opcode::since, phi, psi, 0, 0));
    std::vector<Signal> outputs;
    CHECK(!ways::offline(builder.program(), {{-1, 5, 4, -2}, {3, -inf, -inf, -inf}}, 4, outputs));
    CHECK((outputs[0] == Signal{3, 3, 3, -2}));
}
