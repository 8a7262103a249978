#include "discrete/zero_copy.hpp"

#include "programs.hpp"
#include "ways.hpp"

using programs::Builder;
using rtamt::Opcode;
using ways::Random;
using ways::Signal;

// Whoever reads an input or writes an output: kernels alone, an output that is an input, one that
// is read by others, one that is two outputs, one that is late.
TEST_CASE("offline gives the same whoever reads inputs and outputs") {
    Random random(11);
    for (const std::size_t count : std::initializer_list<std::size_t>{0, 1, 3, 256, 257, 1100}) {
        const std::vector<Signal> columns{random.signal(count), random.signal(count)};
        Builder builder;
        const auto a = builder.input();
        const auto b = builder.input();
        const auto least = builder.pointwise(Opcode::min, a, b);
        const auto ahead = builder.unary(Opcode::slide_max, least, 5, 4);
        const auto twice = builder.pointwise(Opcode::neg, builder.later(least, 0));
        builder.output(a).output(least).output(ahead).output(twice).output(twice);
        builder.output(builder.pointwise(Opcode::abs, b));
        builder.output(builder.later(b, 300));
        ways::check_all_ways(builder.program(), columns, count, random,
                             "count " + std::to_string(count));
    }
}

TEST_CASE("one kernel over a whole trace gives what it gives block by block") {
    Random random(12);
    constexpr std::size_t count = 10'000;
    const std::vector<Signal> columns{random.signal(count), random.signal(count)};
    for (const Opcode opcode : {Opcode::min, Opcode::run_max, Opcode::slide_max, Opcode::since}) {
        Builder builder;
        const auto a = builder.input();
        const auto b = builder.input();
        if (opcode == Opcode::min) {
            builder.output(builder.pointwise(opcode, a, b));
        } else if (opcode == Opcode::since) {
            builder.output(builder.binary(opcode, a, b, 50, 0));
        } else {
            builder.output(builder.unary(opcode, a, 50, 0));
        }
        ways::Executor executor(builder.program());
        std::vector<Signal> outputs;
        CHECK(!ways::offline(executor.program(), columns, count, outputs));
        CHECK(outputs == ways::online(executor, columns, count, random, 2000));
    }
}
