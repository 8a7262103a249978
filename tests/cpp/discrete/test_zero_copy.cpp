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

// Blocks are longer once all of them are present: results come from registers, from the caller's
// memory, or from both, of traces that are shorter and longer than the one before.
TEST_CASE("long blocks of whole traces give what short ones give") {
    Random random(13);
    Builder builder;
    const auto a = builder.input();
    const auto b = builder.input();
    const auto low = builder.unary(Opcode::slide_min, a, 21, 20);
    const auto late = builder.later(b, 20);
    for (const double limit : {0.0, 1.0, -2.0}) {
        const auto margin = builder.pointwise(Opcode::sub, low, builder.constant(limit));
        const auto other = builder.pointwise(Opcode::sub, builder.constant(limit), late);
        builder.output(builder.pointwise(Opcode::min, margin, other));
    }
    const auto read = builder.pointwise(Opcode::max, low, late);
    builder.output(read).output(builder.unary(Opcode::run_max, read, 0, 20)).output(late);
    ways::Executor whole(builder.program());
    ways::Executor stepped(builder.program());
    for (const std::size_t count : {300U, 5000U, 10U, 2000U, 9000U}) {
        const std::vector<Signal> columns{random.signal(count), random.signal(count)};
        std::vector<Signal> outputs(whole.program().outputs.size(), Signal(count));
        std::vector<double*> places;
        for (Signal& output : outputs)
            places.push_back(output.data());
        const std::vector<const double*> samples{columns[0].data(), columns[1].data()};
        CHECK(!whole.evaluate(samples, count, places));
        CHECK(outputs == ways::online(stepped, columns, count, random, 700));
        stepped.reset();
    }
}
