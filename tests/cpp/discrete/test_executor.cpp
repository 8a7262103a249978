#include "discrete/executor.hpp"

#include "random_programs.hpp"
#include "ways.hpp"

#include <stdexcept>

using oracle::inf;
using programs::Builder;
using programs::random_program;
using rtamt::Opcode;
using rtamt::Program;
using ways::Executor;
using ways::Outcome;
using ways::Random;
using ways::Signal;

namespace {

std::vector<std::optional<double>> registers(const Executor& executor) {
    std::vector<std::optional<double>> values;
    for (std::uint32_t i = 0; i < executor.program().instructions.size(); ++i) {
        values.push_back(executor.last(i));
    }
    return values;
}

// Equal where both are numbers; garbage in absent slots may be NaN.
bool same(const std::vector<std::optional<double>>& a,
          const std::vector<std::optional<double>>& b) {
    return std::ranges::equal(a, b, [](const auto& x, const auto& y) {
        return x == y || (x && y && std::isnan(*x) && std::isnan(*y));
    });
}

Signal appended(Signal signal, const Signal& more, std::size_t begin, std::size_t count) {
    const auto from = more.begin() + static_cast<std::ptrdiff_t>(begin);
    signal.insert(signal.end(), from, from + static_cast<std::ptrdiff_t>(count));
    return signal;
}

} // namespace

TEST_CASE("random programs offline are their definition") {
    Random random(10);
    int failed = 0;
    for (int round = 0; round < 1500; ++round) {
        const Program program = random_program(random, static_cast<int>(random.between(1, 12)));
        const auto count = static_cast<std::size_t>(random.between(0, 60));
        const std::vector<Signal> columns{random.signal(count, 1), random.signal(count, 1)};
        const auto expected = oracle::answer(program, columns, count);
        std::vector<Signal> outputs;
        const auto failure = ways::offline(program, columns, count, outputs);
        const std::string note = "round " + std::to_string(round);
        CHECK_MESSAGE(failure.has_value() == expected.undefined.has_value(), note);
        if (failure && expected.undefined) {
            ++failed;
            CHECK_MESSAGE(failure->instruction == expected.undefined->first, note);
            CHECK_MESSAGE(failure->sample == expected.undefined->second, note);
        } else {
            CHECK_MESSAGE(outputs == expected.outputs, note);
        }
    }
    CHECK((failed > 100 && failed < 1400)); // both kinds were tried
}

// Online in random chunks, where a chunk that fails is taken back and left out: what comes out is
// the definition of the samples that were accepted, and each failure is the definition's first.
TEST_CASE("random programs online are their definition and failures leave no trace") {
    Random random(11);
    int failed = 0;
    int finish_failed = 0;
    for (int round = 0; round < 1500; ++round) {
        const std::string note = "round " + std::to_string(round);
        const Program program = random_program(random, static_cast<int>(random.between(1, 12)));
        const bool large = random.chance(15);
        const std::size_t count = large ? 700 : 40;
        const std::vector<Signal> columns{random.signal(count, 1), random.signal(count, 1)};
        Executor executor(program);
        std::vector<Signal> accepted(2);
        std::vector<Signal> outputs(2);
        for (std::size_t begin = 0; begin < count;) {
            const auto chunk = std::min<std::size_t>(
                count - begin, static_cast<std::size_t>(random.between(1, large ? 400 : 9)));
            const auto before = registers(executor);
            const std::vector<Signal> tried{appended(accepted[0], columns[0], begin, chunk),
                                            appended(accepted[1], columns[1], begin, chunk)};
            if (const auto failure = ways::push(executor, columns, begin, chunk, outputs)) {
                ++failed;
                CHECK_MESSAGE(same(registers(executor), before), note);
                if (!large) {
                    const auto expected = oracle::answer(program, tried, tried[0].size());
                    CHECK_MESSAGE(expected.undefined ==
                                      std::pair(failure->instruction, failure->sample),
                                  note);
                }
            } else {
                accepted = tried;
            }
            CHECK(executor.samples() == static_cast<std::int64_t>(accepted[0].size()));
            begin += chunk;
        }
        if (large && accepted[0].size() > 200) continue; // the oracle is slow
        const auto expected = oracle::answer(program, accepted, accepted[0].size());
        if (const auto failure = ways::finish(executor, outputs)) {
            ++finish_failed;
            CHECK_MESSAGE(expected.undefined == std::pair(failure->instruction, failure->sample),
                          note);
            CHECK(!executor.finished());
            const auto again = ways::finish(executor, outputs);
            CHECK_MESSAGE((again && again->instruction == failure->instruction), note);
        } else {
            CHECK_MESSAGE(!expected.undefined, note);
            CHECK_MESSAGE(outputs == expected.outputs, note);
        }
    }
    CHECK(failed > 500);
    CHECK(finish_failed > 10);
}

TEST_CASE("one sample steps are chunks of one") {
    Random random(12);
    for (int round = 0; round < 300; ++round) {
        const Program program = random_program(random, static_cast<int>(random.between(1, 12)));
        Executor steps(program);
        Executor chunks(program);
        const std::vector<Signal> columns{random.signal(50, 1), random.signal(50, 1)};
        for (std::size_t i = 0; i < 50; ++i) {
            const std::vector<double> row{columns[0][i], columns[1][i]};
            double value = 0;
            const Outcome outcome = steps.step(row.data(), value);
            std::vector<Signal> outputs(2);
            const auto failure = ways::push(chunks, columns, i, 1, outputs);
            CHECK((outcome == Outcome::failed) == failure.has_value());
            if (failure) {
                CHECK(steps.failure().instruction == failure->instruction);
                CHECK(steps.failure().sample == failure->sample);
            } else {
                CHECK((outcome == Outcome::known) == !outputs[0].empty());
                if (outcome == Outcome::known) CHECK(outputs[0] == Signal{value});
            }
        }
        CHECK(steps.samples() == chunks.samples());
        CHECK(same(registers(steps), registers(chunks)));
    }
}

TEST_CASE("steps and chunks can be mixed and reset forgets everything") {
    Random random(13);
    Builder builder;
    const auto a = builder.input();
    const auto b = builder.input();
    const auto change = builder.pointwise(Opcode::sub, a, builder.unary(Opcode::shift, a, 1, 0, 0));
    const auto until = builder.binary(Opcode::until, change, b, 5, 4);
    builder.plain().output(builder.unary(Opcode::slide_max, until, 20, 4));
    const std::vector<Signal> columns{random.signal(1000, 0), random.signal(1000, 0)};
    const auto expected = oracle::answer(builder.program(), columns, 1000);
    Executor executor(builder.program());
    for (int round = 0; round < 3; ++round) {
        std::vector<Signal> outputs(1);
        for (std::size_t i = 0; i < 1000;) {
            if (random.chance(50)) {
                const std::vector<double> row{columns[0][i], columns[1][i]};
                double value = 0;
                if (executor.step(row.data(), value) == Outcome::known) outputs[0].push_back(value);
                ++i;
            } else {
                const auto chunk = std::min<std::size_t>(
                    1000 - i, static_cast<std::size_t>(random.between(1, round == 0 ? 3 : 600)));
                CHECK(!ways::push(executor, columns, i, chunk, outputs));
                i += chunk;
            }
        }
        CHECK(executor.last(a) == columns[0].back());
        CHECK(!ways::finish(executor, outputs));
        CHECK(outputs == expected.outputs);
        executor.reset();
        CHECK((executor.samples() == 0 && !executor.finished() && !executor.last(a)));
    }
}

TEST_CASE("after finish a sample is refused until reset") {
    Builder builder;
    builder.output(builder.unary(Opcode::slide_max, builder.input(), 3, 2));
    Executor executor(builder.program());
    std::vector<Signal> outputs(1);
    CHECK(!ways::push(executor, {{1, 2, 3}}, 0, 3, outputs));
    CHECK(executor.remaining(0) == 2);
    CHECK(!ways::finish(executor, outputs));
    CHECK((outputs[0] == Signal{3, 3, 3}));
    CHECK((executor.samples() == 3 && executor.remaining(0) == 0));
    CHECK((!ways::finish(executor, outputs) && outputs[0].size() == 3));
    CHECK(thrown<std::logic_error>([&] { (void)ways::push(executor, {{1}}, 0, 1, outputs); }) ==
          "The trace has ended: reset the monitor before the next sample.");
    executor.reset();
    CHECK(!ways::push(executor, {{7, 8, 9}}, 0, 3, outputs));
    CHECK((outputs[0] == Signal{3, 3, 3, 9}));
}

// A window and a delay of a difference, with lags far beyond what they need, and an output between.
Program late(std::int64_t lag) {
    Builder builder;
    const auto difference = builder.pointwise(Opcode::sub, builder.input(), builder.constant(1));
    const auto window = builder.unary(Opcode::slide_max, difference, 3, lag, -inf);
    const auto delay = builder.unary(Opcode::shift, window, 4, lag + 4, 7);
    builder.output(delay).output(difference);
    return builder.output(builder.unary(Opcode::slide_min, delay, 2, 2 * lag)).program();
}

TEST_CASE("the end of a short trace with a lag of years comes at once") {
    const std::vector<Signal> columns{{5, 2, 4, -1, 6}};
    const std::size_t count = columns[0].size();
    std::vector<Signal> expected(3);
    Executor near(late(300));
    CHECK(!ways::push(near, columns, 0, count, expected));
    CHECK(!ways::finish(near, expected));
    CHECK((expected[0] == Signal(5, -inf) && expected[2] == Signal(5, inf)));
    constexpr std::int64_t far = 140'737'488'355'328; // 2^47
    for (const std::size_t samples : {std::size_t{0}, count}) {
        Executor executor(late(far));
        std::vector<Signal> outputs(3);
        CHECK(!ways::push(executor, columns, 0, samples, outputs));
        CHECK(!ways::finish(executor, outputs));
        CHECK(executor.finished());
        for (std::size_t output = 0; output < outputs.size(); ++output) {
            CHECK(outputs[output] == (samples == 0 ? Signal{} : expected[output]));
        }
    }
    std::vector<Signal> whole(3, Signal(count));
    CHECK(!Executor::evaluate(late(far), ways::pointers(columns, 0), count, ways::pointers(whole)));
    CHECK(whole == expected);
}

TEST_CASE("an empty trace has no values") {
    Builder builder;
    const auto a = builder.input();
    builder.output(builder.unary(Opcode::slide_max, a, 3, 2)).output(a).output(builder.constant(1));
    Executor executor(builder.program());
    std::vector<Signal> outputs(3);
    CHECK(!ways::push(executor, {{}}, 0, 0, outputs));
    CHECK(!ways::finish(executor, outputs));
    CHECK((outputs[0].empty() && outputs[1].empty() && outputs[2].empty()));
}

TEST_CASE("a program without inputs counts samples") {
    Builder builder;
    const auto one = builder.constant(1);
    builder.output(builder.pointwise(Opcode::sub, one, one)).output(one);
    Executor executor(builder.program());
    std::vector<Signal> outputs(2);
    CHECK(!ways::push(executor, {}, 0, 300, outputs));
    CHECK((outputs[0] == Signal(300, 0.0) && outputs[1] == Signal(300, 1.0)));
}

TEST_CASE("memory is the state of a new executor") {
    Random random(14);
    for (int round = 0; round < 100; ++round) {
        const Program program = random_program(random, 10);
        CHECK(Executor::memory(program) == Executor(program).state_bytes());
    }
    Builder builder; // memory() of a program too large for any machine
    const auto a = builder.unary(Opcode::slide_max, builder.input(), rtamt::longest, 0);
    builder.output(a);
    CHECK(Executor::memory(builder.program()) ==
          8 * (static_cast<std::size_t>(rtamt::longest) + 2));
}

TEST_CASE("a program larger than the address space is refused") {
    Builder builder;
    auto a = builder.input();
    for (int i = 0; i < 8200; ++i) {
        a = builder.unary(Opcode::slide_max, a, rtamt::longest, 0);
    }
    builder.output(a);
    CHECK(thrown<std::invalid_argument>([&] { (void)Executor::memory(builder.program()); }) ==
          "This program needs more memory than can be addressed: make its time bounds smaller or "
          "its period longer.");
}

TEST_CASE("first update that fails leaves a new monitor") {
    Builder builder;
    const auto a = builder.input();
    const auto b = builder.input();
    const auto most = builder.unary(Opcode::run_max, b, 0, 0);
    builder.plain().output(
        builder.pointwise(Opcode::add, most, builder.pointwise(Opcode::sqrt, a)));
    Executor executor(builder.program());
    const std::vector<double> bad{-1.0, 100.0};
    const std::vector<double> good{4.0, 1.0};
    double value = 0;
    CHECK(executor.step(bad.data(), value) == Outcome::failed);
    CHECK((executor.failure().instruction == 3 && executor.failure().sample == 0));
    CHECK((!executor.last(a) && executor.samples() == 0));
    CHECK(executor.step(good.data(), value) == Outcome::known);
    CHECK(value == 3.0);
    CHECK(executor.step(bad.data(), value) == Outcome::failed);
    CHECK((executor.last(a) == 4.0 && executor.last(b) == 1.0 && executor.last(most) == 1.0));
    CHECK((executor.step(good.data(), value) == Outcome::known && value == 3.0));
}
