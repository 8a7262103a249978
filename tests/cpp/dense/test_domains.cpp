// The executor of dense time over every value domain, against that over reals.
#include "domain_programs.hpp"
#include "random_programs.hpp"
#include "value_ways.hpp"
#include "values/interval.hpp"
#include "values/lanes.hpp"
#include "values/laws.hpp"
#include "values/truth.hpp"

#include <string>

using dense_ways::check_online;
using dense_ways::component;
using dense_ways::Failure;
using dense_ways::Lists;
using dense_ways::offline;
using dense_ways::Random;
using dense_ways::Trace;
using programs::random_program;
using rtamt::Interval;
using rtamt::Lanes;
using rtamt::Program;
using rtamt::Real;
using rtamt::Truth;

namespace {

template <class D>
Trace<D> sampled(Random& random, std::size_t events) {
    Trace<D> trace;
    for (const auto& signal :
         dense_oracle::random_trace(random, 2, events, random.between(-9, 9))) {
        trace.push_back({signal.times, {}});
        for (std::size_t i = 0; i < signal.size(); ++i)
            trace.back().values.push_back(laws::Sampler<typename D::Number>::one(random));
    }
    return trace;
}

// Where a failure is in the order in which they are reported.
std::pair<std::int64_t, std::uint32_t> order(const Program& program, const Failure& failure) {
    return {failure.time + program.instructions[failure.instruction].lag, failure.instruction};
}

const auto itself = [](double x) { return x; };

std::string round_note(int round) {
    return "round " + std::to_string(round);
}

} // namespace

TEST_CASE("eight lanes are eight traces") {
    using Eight = Lanes<8>;
    Random random(1);
    int failed = 0;
    for (int round = 0; round < 300; ++round) {
        const std::string note = round_note(round);
        const Program program =
            random_program(random, static_cast<int>(random.between(1, 10)), rtamt::Domain::dense);
        const auto trace = sampled<Eight>(random, 25);
        Lists<Eight> outputs;
        const auto failure = offline<Eight>(program, trace, outputs);
        std::optional<Failure> first;
        for (std::size_t lane = 0; lane < 8; ++lane) {
            const auto get = [&](const Eight::Value& value) { return value.lane[lane]; };
            Lists<Real> expected;
            if (const auto found = offline<Real>(program, component<Eight>(trace, get), expected)) {
                if (!first || order(program, *found) < order(program, *first)) first = found;
            }
            if (failure) continue;
            for (std::size_t output = 0; output < outputs.size(); ++output) {
                CHECK_MESSAGE(component(outputs[output].view(), get) ==
                                  component(expected[output].view(), itself),
                              note);
            }
        }
        CHECK_MESSAGE(failure.has_value() == first.has_value(), note);
        if (failure && first)
            CHECK_MESSAGE(order(program, *failure) == order(program, *first), note);
        failed += failure ? 1 : 0;
        check_online<Eight>(program, trace, 6, random, failure ? nullptr : &outputs, note);
    }
    CHECK((failed > 30 && failed < 270)); // both kinds were tried
}

TEST_CASE("bounds are two runs at the corners") {
    Random random(2);
    int compared = 0;
    for (int round = 0; round < 6000 && compared < 300; ++round) {
        const std::string note = round_note(round);
        const Program program =
            random_program(random, static_cast<int>(random.between(1, 9)), rtamt::Domain::dense);
        if (!programs::monotone(program)) continue;
        const auto trace = sampled<Interval>(random, 25);
        Trace<Real> ends;
        for (const auto& steps : trace) {
            ends.push_back({steps.times, {}});
            ends.push_back({steps.times, {}});
            for (const auto& bounds : steps.values) {
                ends[ends.size() - 2].values.push_back(bounds.lower);
                ends[ends.size() - 1].values.push_back(bounds.upper);
            }
        }
        Lists<Real> expected;
        if (offline<Real>(programs::corners(program), ends, expected)) continue; // inf - inf
        ++compared;
        Lists<Interval> outputs;
        CHECK_MESSAGE(!offline<Interval>(program, trace, outputs), note);
        for (std::size_t output = 0; output < outputs.size(); ++output) {
            const auto lower = [](const auto& bounds) { return bounds.lower; };
            const auto upper = [](const auto& bounds) { return bounds.upper; };
            CHECK_MESSAGE(component(outputs[output].view(), lower) ==
                              component(expected[2 * output].view(), itself),
                          note);
            CHECK_MESSAGE(component(outputs[output].view(), upper) ==
                              component(expected[2 * output + 1].view(), itself),
                          note);
        }
        check_online<Interval>(program, trace, 8, random, &outputs, note);
    }
    CHECK(compared == 300);
}

TEST_CASE("sixty four truth values are the signs of sixty four robustnesses") {
    Random random(3);
    for (int round = 0; round < 80; ++round) {
        const std::string note = round_note(round);
        const Program program =
            programs::truth_program(random, static_cast<int>(random.between(1, 12)));
        auto trace = sampled<Truth>(random, 15);
        for (auto& value : trace[1].values) // the second input is true or false
            value = Truth::number(laws::Sampler<Truth>::one(random));
        Lists<Truth> outputs;
        CHECK_MESSAGE(!offline<Truth>(program, trace, outputs), note);
        for (std::size_t k = 0; k < Truth::traces; ++k) {
            const auto lane = [&](const auto& value) { return value.lane[k]; };
            Lists<Real> robustness;
            CHECK_MESSAGE(!offline<Real>(program, component<Truth>(trace, lane), robustness), note);
            for (std::size_t output = 0; output < outputs.size(); ++output) {
                const auto bit = [&](std::uint64_t word) { return (word >> k) & 1U ? 1.0 : 0.0; };
                const auto sign = [](double x) { return x > 0 ? 1.0 : 0.0; };
                CHECK_MESSAGE(component(outputs[output].view(), bit) ==
                                  component(robustness[output].view(), sign),
                              note);
            }
        }
        check_online<Truth>(program, trace, 5, random, &outputs, note);
    }
}

TEST_CASE("a program with code of its own is for reals") {
    const rtamt_kernel kernel{};
    programs::Builder builder;
    builder.output(builder.call(kernel, {}, {builder.input()}, 0));
    CHECK(thrown<std::invalid_argument>([&] {
              const rtamt::dense::BasicExecutor<Interval> executor(builder.program());
          }) == "This program runs code of its own, which computes with real numbers only.");
}
