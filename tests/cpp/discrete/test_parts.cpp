#include "discrete/parts.hpp"

#include "check.hpp"
#include "program/threads.hpp"
#include "random_programs.hpp"
#include "ways.hpp"

#include <atomic>
#include <bit>
#include <cstddef>
#include <limits>
#include <stdexcept>

using oracle::inf;
using programs::Builder;
using rtamt::Opcode;
using rtamt::Program;
using rtamt::discrete::Executor;
using rtamt::discrete::parts;
using rtamt::discrete::reach;
using ways::Random;
using ways::Signal;

namespace {

struct Found {
    std::vector<Signal> outputs;
    bool failed = false;
    std::size_t parts = 0;
};

// In parts of at least `least` samples.
Found in_parts(const Program& program, const std::vector<Signal>& columns, std::size_t count,
               std::size_t least, std::size_t threads) {
    Found found;
    std::vector<const double*> from;
    for (const Signal& column : columns)
        from.push_back(column.data());
    std::vector<double*> to;
    found.outputs.assign(program.outputs.size(), Signal(count, std::nan("")));
    for (Signal& output : found.outputs)
        to.push_back(output.data());
    std::unique_ptr<Executor> executor;
    const auto places = parts(program, count, least);
    found.parts = places.size() - 1;
    found.failed =
        rtamt::discrete::evaluate_parts(program, places, from, to, threads, executor).has_value();
    return found;
}

std::vector<std::uint64_t> bits(const Signal& signal) {
    std::vector<std::uint64_t> bits;
    for (const double value : signal)
        bits.push_back(std::bit_cast<std::uint64_t>(value));
    return bits;
}

Program response(std::int64_t width) {
    Builder builder;
    const auto a = builder.input();
    const auto b = builder.input();
    const auto soon = builder.unary(Opcode::slide_max, b, 6, 5);
    const auto none = builder.later(builder.pointwise(Opcode::neg, a), 5);
    const auto implied = builder.pointwise(Opcode::max, none, soon);
    builder.output(builder.unary(Opcode::slide_min, implied, width, width + 4));
    builder.output(soon);
    return builder.program();
}

} // namespace

TEST_CASE("parts of a trace have the values of the whole") {
    Random random(20);
    int parted = 0;
    for (int round = 0; round < 3000; ++round) {
        const Program program =
            programs::random_program(random, static_cast<int>(random.between(1, 8)));
        const auto count = static_cast<std::size_t>(random.between(100, 1200));
        const std::vector<Signal> columns{random.signal(count, 1), random.signal(count, 1)};
        std::vector<Signal> outputs;
        const auto failure = ways::offline(program, columns, count, outputs);
        const Found found = in_parts(program, columns, count, 20, 1);
        const std::string note = "round " + std::to_string(round);
        CHECK_MESSAGE(found.failed == failure.has_value(), note);
        if (!failure && !found.failed) CHECK_MESSAGE(found.outputs == outputs, note);
        if (found.parts > 1) ++parted;
    }
    CHECK(parted > 800);
}

TEST_CASE("the number of threads changes no bit, the signs of zeros included") {
    Random random(21);
    for (int round = 0; round < 40; ++round) {
        const std::size_t count = 3000;
        std::vector<Signal> columns(2, Signal(count));
        for (Signal& column : columns) {
            for (double& value : column)
                value = random.chance(50) ? -0.0 : random.chance(90) ? 0.0 : -1.0;
        }
        const Program program = response(random.between(1, 90));
        const Found alone = in_parts(program, columns, count, 100, 1);
        CHECK(alone.parts > 2);
        for (const std::size_t threads : {2U, 3U, 50U}) {
            const Found found = in_parts(program, columns, count, 100, threads);
            for (std::size_t i = 0; i < alone.outputs.size(); ++i)
                CHECK(bits(found.outputs[i]) == bits(alone.outputs[i]));
        }
    }
}

TEST_CASE("a value that is undefined in a later part is found, and the executor is gone") {
    Builder builder;
    const auto a = builder.input();
    const auto b = builder.input();
    builder.output(builder.unary(Opcode::slide_min, builder.pointwise(Opcode::div, a, b), 4, 3));
    const std::size_t count = 1000;
    Signal zeros(count, 1.0);
    Signal divisor(count, 1.0);
    zeros[700] = divisor[700] = 0.0;
    std::vector<const double*> from{zeros.data(), divisor.data()};
    Signal out(count);
    std::vector<double*> to{out.data()};
    std::unique_ptr<Executor> executor;
    const auto places = parts(builder.program(), count, 100);
    const auto failure =
        rtamt::discrete::evaluate_parts(builder.program(), places, from, to, 2, executor);
    REQUIRE(failure);
    CHECK(failure->sample == 700);
    CHECK(!executor);
}

TEST_CASE("sums, everything before and short traces are in one part") {
    const auto places = [](const Program& program, std::size_t count) {
        return parts(program, count, 10).size() - 1;
    };
    for (const Opcode opcode : {Opcode::slide_sum, Opcode::run_max, Opcode::run_sum}) {
        Builder builder;
        builder.output(builder.unary(opcode, builder.input(), 3, 0));
        CHECK(!reach(builder.program()));
        CHECK(places(builder.program(), 10'000) == 1);
    }
    Builder builder;
    const auto a = builder.input();
    builder.output(builder.binary(Opcode::since, a, builder.input(), 0, 0));
    CHECK(!reach(builder.program()));
    CHECK(places(response(3), 19) == 1);
    CHECK(places(response(3), 10'000) > 50);
    CHECK(places(response(2000), 10'000) == 1); // most samples would be read twice
    const auto found = reach(response(3));
    REQUIRE(found);
    CHECK(found->after == 7);
    CHECK(found->before == 0);
}

TEST_CASE("an exception of one thread reaches the caller, and the others end") {
    std::atomic<std::size_t> done{0};
    const auto work = [&](std::size_t /*thread*/, std::size_t piece) {
        ++done;
        if (piece == 3) throw std::runtime_error("piece 3");
    };
    // So many pieces that the call returns only because the others leave them.
    constexpr std::size_t endless = std::numeric_limits<std::size_t>::max() / 2;
    CHECK(thrown<std::runtime_error>([&] { rtamt::share_work(endless, 3, work); }) == "piece 3");
    done = 0;
    CHECK(thrown<std::runtime_error>([&] { rtamt::share_work(endless, 1, work); }) == "piece 3");
    CHECK(done == 4);
    done = 0;
    rtamt::share_work(0, 4, work);
    CHECK(done == 0);
}
