#include "dense/executor.hpp"

#include "random_programs.hpp"
#include "ways.hpp"

#include <stdexcept>

using dense_oracle::inf;
using programs::Builder;
using programs::random_program;
using rtamt::Opcode;
using rtamt::Program;
using ways::EventList;
using ways::Events;
using ways::Executor;
using ways::Online;
using ways::Random;
using ways::Signal;
using ways::Trace;

namespace {

std::string round_note(int round) {
    return "round " + std::to_string(round);
}

} // namespace

TEST_CASE("random programs offline are their definition") {
    Random random(20);
    int failed = 0;
    for (int round = 0; round < 1500; ++round) {
        const Program program =
            random_program(random, static_cast<int>(random.between(1, 12)), rtamt::Domain::dense);
        const Trace trace = dense_oracle::random_trace(random, 2, 20, random.between(-50, 50), 1);
        const std::int64_t extra = random.chance(30) ? random.between(0, 30) : 0;
        const auto expected = dense_oracle::answer(program, trace, extra);
        std::vector<Signal> outputs;
        const auto failure = ways::offline(program, trace, outputs, extra);
        CHECK_MESSAGE(failure.has_value() == expected.undefined.has_value(), round_note(round));
        if (failure && expected.undefined) {
            ++failed;
            CHECK_MESSAGE(failure->instruction == expected.undefined->instruction,
                          round_note(round));
            CHECK_MESSAGE(failure->time == expected.undefined->time, round_note(round));
        } else {
            CHECK_MESSAGE(outputs == expected.outputs, round_note(round));
        }
    }
    CHECK((failed > 100 && failed < 1400)); // both kinds were tried
}

TEST_CASE("one executor evaluates trace after trace as their definition, unless one fails") {
    Random random(24);
    int again = 0;
    for (int round = 0; round < 400; ++round) {
        const std::string note = round_note(round);
        const Program program =
            random_program(random, static_cast<int>(random.between(1, 10)), rtamt::Domain::dense);
        Executor executor(program);
        for (int number = 0; number < 4; ++number) {
            const Trace trace =
                dense_oracle::random_trace(random, 2, 20, random.between(-50, 50), 1);
            const std::int64_t extra = random.chance(30) ? random.between(0, 30) : 0;
            const auto expected = dense_oracle::answer(program, trace, extra);
            std::vector<EventList> lists(program.outputs.size());
            const std::vector<Events> inputs{trace[0].events(0, trace[0].size()),
                                             trace[1].events(0, trace[1].size())};
            const auto failure = executor.evaluate(inputs, extra, lists);
            CHECK_MESSAGE(failure.has_value() == expected.undefined.has_value(), note);
            if (failure) break;
            again += number;
            CHECK_MESSAGE(ways::signals_of(lists) == expected.outputs, note);
        }
    }
    CHECK(again > 500);
}

// Online in random chunks, where a chunk that fails is taken back and left out: after each update
// exactly what is known is reported of the events that were accepted, and each failure is the
// definition's first.
TEST_CASE("random programs online are their definition and failures leave no trace") {
    Random random(21);
    int failed = 0;
    int finished = 0;
    int finish_failed = 0;
    for (int round = 0; round < 1200; ++round) {
        const std::string note = round_note(round);
        const Program program =
            random_program(random, static_cast<int>(random.between(1, 10)), rtamt::Domain::dense);
        const Trace all = dense_oracle::random_trace(random, 2, 20, random.between(-50, 50), 1);
        Executor executor(program);
        // Events that were refused are left out of `trace`, which grows event by event.
        Trace trace(2);
        std::vector<EventList> outputs(2);
        std::vector<std::size_t> next(2, 0);
        while (next[0] < all[0].size() || next[1] < all[1].size()) {
            Trace tried = trace;
            Trace chunk(2);
            for (std::size_t i = 0; i < 2; ++i) {
                const auto rest = static_cast<std::int64_t>(all[i].size() - next[i]);
                for (auto n = std::min(rest, random.between(0, 4)); n > 0; --n, ++next[i]) {
                    chunk[i].add(all[i].times[next[i]], all[i].values[next[i]]);
                    tried[i].add(all[i].times[next[i]], all[i].values[next[i]]);
                }
            }
            const std::vector<Events> inputs{chunk[0].events(0, chunk[0].size()),
                                             chunk[1].events(0, chunk[1].size())};
            const bool complete = tried[0].size() != 0 && tried[1].size() != 0;
            const auto failure = executor.push(inputs, outputs);
            if (!complete) {
                CHECK_MESSAGE((!failure && outputs[0].count() == 0), note);
                trace = tried;
                continue;
            }
            const auto expected = dense_oracle::answer(program, tried);
            const bool undefined = expected.undefined &&
                                   expected.undefined->arrival <= dense_oracle::frontier_of(tried);
            CHECK_MESSAGE(failure.has_value() == undefined, note);
            if (failure) {
                ++failed;
                CHECK_MESSAGE(failure->instruction == expected.undefined->instruction, note);
                CHECK_MESSAGE(failure->time == expected.undefined->time, note);
            } else {
                trace = tried;
                for (std::size_t i = 0; i < 2; ++i) {
                    const auto known = executor.known_until(i);
                    const std::int64_t lag = program.instructions[program.outputs[i]].lag;
                    const std::int64_t until = dense_oracle::frontier_of(trace) - lag;
                    CHECK_MESSAGE(known.has_value() == (until >= dense_oracle::start_of(trace)),
                                  note);
                    if (known) CHECK_MESSAGE(*known == until, note);
                    CHECK_MESSAGE(dense_oracle::signal_of(outputs[i].view()) ==
                                      (known ? expected.outputs[i].merged(until) : Signal{}),
                                  note);
                }
            }
            for (std::size_t i = 0; i < 2; ++i) {
                CHECK(executor.last_time(i).has_value() == (trace[i].size() != 0));
                if (trace[i].size() != 0) CHECK(executor.last_time(i) == trace[i].times.back());
            }
        }
        if (trace[0].size() == 0 || trace[1].size() == 0) {
            CHECK((!executor.finish(outputs) && outputs[0].count() == 0));
            continue;
        }
        const auto expected = dense_oracle::answer(program, trace);
        if (const auto failure = executor.finish(outputs)) {
            ++finish_failed;
            CHECK_MESSAGE((expected.undefined && expected.undefined->time == failure->time), note);
            CHECK(!executor.finished());
            const auto again = executor.finish(outputs);
            CHECK_MESSAGE((again && again->instruction == failure->instruction), note);
        } else {
            ++finished;
            CHECK_MESSAGE(!expected.undefined, note);
            CHECK_MESSAGE(ways::signals_of(outputs) == expected.outputs, note);
        }
    }
    CHECK((failed > 300 && finished > 300 && finish_failed > 10));
}

TEST_CASE("chunks of many blocks that fail leave no trace") {
    Random random(22);
    Builder builder;
    const auto a = builder.input();
    const auto b = builder.input();
    const auto most = builder.unary(Opcode::slide_max, a, 40, 0);
    const auto until = builder.binary(Opcode::until, most, b, 25, 0);
    const auto late = builder.unary(Opcode::shift, until, 30, 0, 0);
    const auto since = builder.binary(Opcode::since, late, b, 0, 0);
    const auto root = builder.pointwise(
        Opcode::sqrt, builder.pointwise(Opcode::add, since, builder.constant(50)));
    builder.output(builder.unary(Opcode::slide_min, root, 10, 10));
    Trace trace{dense_oracle::random_signal(random, 0, 1500, 0),
                dense_oracle::random_signal(random, 3, 1500, 0)};
    const auto expected = dense_oracle::answer(builder.program(), trace);
    Trace bad = trace;
    for (Signal& signal : bad) {
        for (std::size_t i = signal.size() - 100; i < signal.size(); ++i)
            signal.values[i] = -1000;
    }
    const auto reference = dense_oracle::answer(builder.program(), bad);
    CHECK((!expected.undefined && reference.undefined));
    Executor executor(builder.program());
    for (const std::size_t cut : {std::size_t{0}, std::size_t{1}, std::size_t{700}}) {
        std::vector<EventList> outputs(1);
        const auto push = [&](const Trace& from, std::size_t begin, std::size_t end) {
            return executor.push(std::vector<Events>{from[0].events(begin, end - begin),
                                                     from[1].events(begin, end - begin)},
                                 outputs);
        };
        CHECK(!push(trace, 0, cut));
        for (int again = 0; again < 2; ++again) {
            const auto failure = push(bad, cut, 1500);
            CHECK((failure && failure->instruction == root));
            CHECK((failure && failure->time == reference.undefined->time));
        }
        CHECK((!push(trace, cut, 1500) && !executor.finish(outputs)));
        CHECK(ways::signals_of(outputs) == expected.outputs);
        executor.reset();
    }
}

TEST_CASE("a value that nothing reads after the end may be undefined") {
    // 1 / once[0,5](x) with x = 0 from 3 on is 1/0 = inf; 0 / it would be 0/0 from 8 on, after the
    // end at 6: that is no failure, unless a future operator looks so far.
    Builder builder;
    const auto x = builder.input();
    const auto once = builder.unary(Opcode::slide_max, x, 5, 0);
    const auto ratio = builder.pointwise(Opcode::div, builder.constant(0), once);
    const Trace trace{{{0, 3, 6}, {1, 0, 0}}};
    std::vector<Signal> outputs;
    Builder now = builder;
    now.output(ratio);
    CHECK(!ways::offline(now.program(), trace, outputs));
    CHECK((outputs[0] == Signal{{0}, {0}}));
    Builder beside = builder;
    beside.output(beside.pointwise(Opcode::max, beside.later(ratio, 9),
                                   beside.unary(Opcode::slide_max, x, 9, 9)));
    CHECK(!ways::offline(beside.program(), trace, outputs));
    Builder future = builder;
    future.output(future.unary(Opcode::slide_max, ratio, 1, 1));
    CHECK(!ways::offline(future.program(), trace, outputs));
    Builder farther = builder;
    farther.output(farther.unary(Opcode::slide_max, ratio, 2, 2));
    const auto failure = ways::offline(farther.program(), trace, outputs);
    CHECK((failure && failure->instruction == ratio && failure->time == 8));
}

TEST_CASE("the trace begins when every input has come") {
    Builder builder;
    const auto a = builder.input();
    const auto b = builder.input();
    builder.output(builder.pointwise(Opcode::max, a, b)).output(a);
    Executor executor(builder.program());
    const Trace trace{{{0, 2, 9}, {1, 2, 3}}, {{5}, {0}}};
    Online online(executor, trace);
    CHECK(!online.push({2, 0}));
    CHECK((!executor.start() && !executor.known_until(0)));
    CHECK(!online.push({0, 1}));
    CHECK((executor.start() == 5 && !executor.known_until(0))); // a is known until 2 only
    CHECK(!online.push({1, 0}));
    CHECK((executor.known_until(0) == 5 && executor.last_time(0) == 9));
    CHECK((ways::signals_of(online.outputs)[1] == Signal{{5}, {2}}));
    CHECK(!executor.finish(online.outputs));
    CHECK(executor.known_until(0) == 9);
    CHECK((ways::signals_of(online.outputs)[0] == Signal{{5, 9}, {2, 3}}));
}

TEST_CASE("nothing is known without samples") {
    Builder builder;
    builder.output(builder.unary(Opcode::slide_max, builder.input(), 3, 2));
    Executor executor(builder.program());
    std::vector<EventList> outputs(1);
    CHECK((!executor.push(std::vector<Events>(1), outputs) && !executor.finish(outputs)));
    CHECK((outputs[0].count() == 0 && executor.finished() && !executor.known_until(0)));
    Builder constant;
    constant.output(constant.constant(1));
    Executor empty(constant.program());
    CHECK((!empty.push({}, outputs) && !empty.finish(outputs) && outputs[0].count() == 0));
    std::vector<Signal> signals;
    CHECK((!ways::offline(builder.program(), {Signal{}}, signals) && signals[0].size() == 0));
}

TEST_CASE("after finish a sample is refused until reset") {
    Builder builder;
    builder.output(builder.unary(Opcode::slide_max, builder.input(), 3, 2));
    Executor executor(builder.program());
    const Trace trace{{{1, 2, 3}, {1, 2, 3}}};
    Online online(executor, trace);
    CHECK((!online.push({2}) && !executor.finish(online.outputs)));
    CHECK(!executor.finish(online.outputs));
    CHECK(thrown<std::logic_error>([&] { (void)online.push({1}); }) ==
          "The trace has ended: reset the monitor before the next sample.");
    executor.reset();
    CHECK((!executor.start() && !executor.last_time(0) && !executor.finished()));
}

TEST_CASE("the answers at the ends of time are those at 0") {
    Random random(23);
    int checked = 0;
    for (int round = 0; round < 200; ++round) {
        const Program program = random_program(random, 8, rtamt::Domain::dense);
        const Trace trace = dense_oracle::random_trace(random, 2, 20, 0, 1);
        const auto expected = dense_oracle::answer(program, trace);
        if (expected.undefined) continue;
        ++checked;
        const Executor executor(program);
        const std::int64_t last = executor.last_possible() - dense_oracle::end_of(trace);
        for (const std::int64_t base :
             {last, -rtamt::dense::never, std::int64_t{1'000'000'000'000'000'000}}) {
            Trace moved = trace;
            auto outputs = expected.outputs;
            for (auto* signals : {&moved, &outputs}) {
                for (Signal& signal : *signals) {
                    for (std::int64_t& time : signal.times)
                        time += base;
                }
            }
            std::vector<Signal> found;
            CHECK(!ways::offline(program, moved, found));
            CHECK_MESSAGE(found == outputs, (round_note(round) + " at " + std::to_string(base)));
        }
    }
    CHECK(checked > 50);
}

TEST_CASE("the rest of a long window comes in steps") {
    Builder builder;
    const auto a = builder.input();
    builder.output(builder.unary(Opcode::shift, a, 1'000'000, 1'000'000))
        .output(builder.unary(Opcode::slide_max, a, 1'000'000, 1'000'000));
    Executor executor(builder.program());
    Trace trace(1);
    for (std::int64_t t = 0; t < 100'000; ++t)
        trace[0].add(t, -static_cast<double>(t));
    Online online(executor, trace);
    CHECK(!online.push({100'000}));
    CHECK(online.outputs[0].count() == 0);
    const std::size_t before = executor.state_bytes();
    CHECK(!executor.finish(online.outputs));
    CHECK(ways::signals_of(online.outputs)[0] == trace[0]);
    CHECK((ways::signals_of(online.outputs)[1] == trace[0]));
    CHECK(executor.state_bytes() < before + 100'000); // registers did not grow with the window
}
