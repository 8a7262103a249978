#include "dense/since.hpp"

#include "programs.hpp"
#include "ways.hpp"

using programs::Builder;
using rtamt::Opcode;
using ways::Random;
using ways::Signal;

TEST_CASE("since is its definition for any chunks") {
    Random random(3);
    for (int round = 0; round < 200; ++round) {
        Builder builder;
        const auto phi = builder.input();
        const auto psi = builder.input();
        builder.output(builder.binary(Opcode::since, phi, psi, 0, 0));
        builder.output(builder.binary(Opcode::since, phi, phi, 0, 2));
        builder.output(builder.binary(Opcode::since, builder.constant(1), psi, 0, 0));
        ways::check_all_ways(builder.program(), dense_oracle::random_trace(random, 2, 30), random,
                             "round " + std::to_string(round));
    }
}

TEST_CASE("phi counts in the rest of the segment in which psi held") {
    Builder builder;
    const auto phi = builder.input();
    const auto psi = builder.input();
    builder.output(builder.binary(Opcode::since, phi, psi, 0, 0));
    std::vector<Signal> outputs;
    // psi is 5 on [0, 1) while phi is -1: from 1 on only -1 of it is left.
    CHECK(!ways::offline(builder.program(), {{{0, 1}, {-1, 7}}, {{0, 1}, {5, -9}}}, outputs));
    CHECK((outputs[0] == Signal{{0, 1}, {5, -1}}));
}
