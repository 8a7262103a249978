#include "discrete/until.hpp"

#include "programs.hpp"
#include "ways.hpp"

using programs::Builder;
using rtamt::Opcode;
using ways::Random;
using ways::Signal;

TEST_CASE("until is its definition for any width lag and chunks") {
    Random random(8);
    for (const std::size_t count : std::initializer_list<std::size_t>{0, 1, 2, 10, 257, 400}) {
        const std::vector<Signal> columns{random.signal(count), random.signal(count)};
        for (const std::int64_t width : {1, 2, 3, 4, 5, 8, 17, 60, 256, 500}) {
            if (width * static_cast<std::int64_t>(count) > 30000) continue; // the oracle is slow
            for (const std::int64_t head : {0, 3, 70}) {
                Builder builder;
                const auto phi = builder.later(builder.input(), head);
                const auto psi = builder.later(builder.input(), head);
                const auto one = builder.constant(1.0);
                for (const std::int64_t lag : {head, head + width - 1, std::int64_t{0}}) {
                    builder.output(builder.binary(Opcode::until, phi, psi, width, lag));
                }
                builder.output(builder.binary(Opcode::until, phi, phi, width, head + width - 1));
                builder.output(builder.binary(Opcode::until, one, psi, width, head + width + 1));
                builder.output(builder.binary(Opcode::until, phi, one, width, head));
                ways::check_all_ways(builder.program(), columns, count, random,
                                     "width " + std::to_string(width) + ", head " +
                                         std::to_string(head) + ", count " + std::to_string(count));
            }
        }
    }
}

TEST_CASE("phi is not required where psi holds") {
    // x until[0,2] y with x = -1 and y = 3: 3 everywhere.
    Builder builder;
    const auto phi = builder.input();
    const auto psi = builder.input();
    builder.output(builder.binary(Opcode::until, phi, psi, 3, 2));
    std::vector<Signal> outputs;
    CHECK(!ways::offline(builder.program(), {Signal(5, -1.0), Signal(5, 3.0)}, 5, outputs));
    CHECK((outputs[0] == Signal(5, 3.0)));
}

TEST_CASE("a wide until costs two doubles a sample of it") {
    Builder builder;
    const auto phi = builder.input();
    builder.output(builder.binary(Opcode::until, phi, phi, 1000000, 0));
    ways::Executor executor(builder.program());
    CHECK(executor.state_bytes() < 16 * 1000000 + 100);
}
