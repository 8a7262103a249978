// The executor over every value domain, against the executor over reals for each trace or bound.
#include "domain_programs.hpp"
#include "random_programs.hpp"
#include "value_ways.hpp"
#include "values/interval.hpp"
#include "values/lanes.hpp"
#include "values/laws.hpp"
#include "values/truth.hpp"

#include <string>

using programs::Builder;
using programs::corners;
using programs::monotone;
using programs::truth_program;
using rtamt::Instruction;
using rtamt::Interval;
using rtamt::Lanes;
using rtamt::Opcode;
using rtamt::Program;
using rtamt::Real;
using rtamt::Truth;
using value_ways::check_online;
using value_ways::Failure;
using value_ways::offline;
using value_ways::Random;
using value_ways::Samples;
using value_ways::Values;

namespace {

// Samples of two inputs, as many traces as the domain has components.
template <class D>
std::vector<Samples<D>> sampled(Random& random, std::size_t count) {
    std::vector<Samples<D>> samples(2);
    for (auto& input : samples) {
        for (std::size_t i = 0; i < count; ++i)
            input.numbers.push_back(laws::Sampler<typename D::Number>::one(random));
    }
    return samples;
}

// One trace, or one bound, of samples.
template <class D, class Component>
std::vector<Samples<Real>> component(const std::vector<Samples<D>>& samples, Component&& get) {
    std::vector<Samples<Real>> one(samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i) {
        for (const auto& value : samples[i].numbers)
            one[i].numbers.push_back(get(value));
    }
    return one;
}

// Where a failure is in the order in which they are reported.
std::pair<std::int64_t, std::uint32_t> order(const Program& program, const Failure& failure) {
    return {failure.sample + program.instructions[failure.instruction].lag, failure.instruction};
}

} // namespace

TEST_CASE("eight lanes are eight traces") {
    using Eight = Lanes<8>;
    Random random(1);
    int failed = 0;
    for (int round = 0; round < 400; ++round) {
        const std::string note = "round " + std::to_string(round);
        const Program program =
            programs::random_program(random, static_cast<int>(random.between(1, 12)));
        const auto count = static_cast<std::size_t>(random.between(0, 90));
        const auto samples = sampled<Eight>(random, count);
        std::vector<Values<Eight>> outputs;
        const auto failure = offline<Eight>(program, samples, count, outputs);
        std::optional<Failure> first;
        for (std::size_t lane = 0; lane < 8; ++lane) {
            const auto trace = component(samples, [&](const auto& v) { return v.lane[lane]; });
            std::vector<Values<Real>> expected;
            if (const auto found = offline<Real>(program, trace, count, expected)) {
                if (!first || order(program, *found) < order(program, *first)) first = found;
            }
            if (failure) continue;
            for (std::size_t output = 0; output < outputs.size(); ++output) {
                for (std::size_t i = 0; i < count; ++i)
                    CHECK_MESSAGE(outputs[output][i].lane[lane] == expected[output][i], note);
            }
        }
        CHECK_MESSAGE(failure.has_value() == first.has_value(), note);
        if (failure && first)
            CHECK_MESSAGE(order(program, *failure) == order(program, *first), note);
        failed += failure ? 1 : 0;
        check_online<Eight>(program, samples, count, 40, random, failure ? nullptr : &outputs,
                            note);
    }
    CHECK((failed > 50 && failed < 350)); // both kinds were tried
}

TEST_CASE("bounds are two runs at the corners") {
    Random random(2);
    int compared = 0;
    for (int round = 0; round < 8000 && compared < 400; ++round) {
        const std::string note = "round " + std::to_string(round);
        const Program program =
            programs::random_program(random, static_cast<int>(random.between(1, 9)));
        if (!monotone(program)) continue;
        const auto count = static_cast<std::size_t>(random.between(0, 150));
        const auto samples = sampled<Interval>(random, count);
        std::vector<Samples<Real>> ends;
        for (const auto& input : samples) {
            ends.resize(ends.size() + 2);
            for (const auto& bounds : input.numbers) {
                ends[ends.size() - 2].numbers.push_back(bounds.lower);
                ends[ends.size() - 1].numbers.push_back(bounds.upper);
            }
        }
        std::vector<Values<Real>> expected;
        if (offline<Real>(corners(program), ends, count, expected)) continue; // inf - inf
        ++compared;
        std::vector<Values<Interval>> outputs;
        CHECK_MESSAGE(!offline<Interval>(program, samples, count, outputs), note);
        for (std::size_t output = 0; output < outputs.size(); ++output) {
            for (std::size_t i = 0; i < count; ++i) {
                CHECK_MESSAGE(outputs[output][i].lower == expected[2 * output][i], note);
                CHECK_MESSAGE(outputs[output][i].upper == expected[2 * output + 1][i], note);
            }
        }
        check_online<Interval>(program, samples, count, 200, random, &outputs, note);
    }
    CHECK(compared == 400);
}

TEST_CASE("bounds hold the robustness of every trace within them") {
    Random random(3);
    int compared = 0;
    for (int round = 0; round < 1200; ++round) {
        const std::string note = "round " + std::to_string(round);
        const Program program =
            programs::random_program(random, static_cast<int>(random.between(1, 12)));
        const auto count = static_cast<std::size_t>(random.between(0, 60));
        const auto samples = sampled<Interval>(random, count);
        std::vector<Values<Interval>> outputs;
        const auto failure = offline<Interval>(program, samples, count, outputs);
        const auto trace = component(samples, [&](const auto& bounds) {
            const double x = random.number(0);
            if (x >= bounds.lower && x <= bounds.upper) return x;
            return random.chance(50) ? bounds.lower : bounds.upper;
        });
        std::vector<Values<Real>> robustness;
        const bool undefined = offline<Real>(program, trace, count, robustness).has_value();
        if (failure) CHECK_MESSAGE(undefined, note); // undefined for every trace
        check_online<Interval>(program, samples, count, 30, random, failure ? nullptr : &outputs,
                               note);
        if (undefined) continue;
        ++compared;
        for (std::size_t output = 0; output < outputs.size(); ++output) {
            for (std::size_t i = 0; i < count; ++i) {
                CHECK_MESSAGE(outputs[output][i].lower <= robustness[output][i], note);
                CHECK_MESSAGE(outputs[output][i].upper >= robustness[output][i], note);
            }
        }
    }
    CHECK(compared > 300);
}

TEST_CASE("bounds of samples that are known are the robustness") {
    Random random(4);
    for (int round = 0; round < 300; ++round) {
        const std::string note = "round " + std::to_string(round);
        const Program program =
            programs::random_program(random, static_cast<int>(random.between(1, 12)));
        const auto count = static_cast<std::size_t>(random.between(0, 60));
        const auto trace = sampled<Real>(random, count);
        std::vector<Samples<Interval>> samples(2);
        for (std::size_t input = 0; input < 2; ++input) {
            for (const double x : trace[input].numbers)
                samples[input].numbers.push_back(Interval::of(x));
        }
        std::vector<Values<Interval>> outputs;
        std::vector<Values<Real>> robustness;
        const auto failure = offline<Interval>(program, samples, count, outputs);
        const auto expected = offline<Real>(program, trace, count, robustness);
        CHECK_MESSAGE(failure.has_value() == expected.has_value(), note);
        if (failure && expected) {
            CHECK_MESSAGE(order(program, *failure) == order(program, *expected), note);
            continue;
        }
        for (std::size_t output = 0; output < outputs.size(); ++output) {
            for (std::size_t i = 0; i < count; ++i)
                CHECK_MESSAGE(outputs[output][i] == Interval::of(robustness[output][i]), note);
        }
    }
}

TEST_CASE("sixty four truth values are the signs of sixty four robustnesses") {
    Random random(5);
    int crossed = 0;
    for (int round = 0; round < 120; ++round) {
        const std::string note = "round " + std::to_string(round);
        const Program program = truth_program(random, static_cast<int>(random.between(1, 14)));
        const auto count = static_cast<std::size_t>(random.between(0, 80));
        auto samples = sampled<Truth>(random, count);
        samples[1].numbers.clear(); // the second input is true or false
        for (std::size_t i = 0; i < count; ++i) {
            samples[1].formulas.push_back(laws::Sampler<Truth>::one(random));
            samples[1].numbers.push_back(Truth::number(samples[1].formulas.back()));
            samples[0].formulas.push_back(Truth::formula(samples[0].numbers[i]));
        }
        std::vector<Values<Truth>> outputs;
        CHECK_MESSAGE(!offline<Truth>(program, samples, count, outputs), note);
        for (std::size_t k = 0; k < Truth::traces; ++k) {
            const auto trace = component(samples, [&](const auto& v) { return v.lane[k]; });
            std::vector<Values<Real>> robustness;
            CHECK_MESSAGE(!offline<Real>(program, trace, count, robustness), note);
            for (std::size_t output = 0; output < outputs.size(); ++output) {
                for (std::size_t i = 0; i < count; ++i) {
                    const bool holds = ((outputs[output][i] >> k) & 1U) != 0;
                    CHECK_MESSAGE(holds == (robustness[output][i] > 0), note);
                }
            }
        }
        check_online<Truth>(program, samples, count, 30, random, &outputs, note);
        for (const Instruction& instruction : program.instructions)
            crossed += instruction.opcode == Opcode::abs ? 1 : 0;
    }
    CHECK(crossed > 50);
}

TEST_CASE("a program with code of its own is for reals") {
    const rtamt_kernel kernel{};
    Builder builder;
    builder.output(builder.call(kernel, {}, {builder.input()}, 0));
    CHECK(thrown<std::invalid_argument>([&] {
              const rtamt::discrete::BasicExecutor<Interval> executor(builder.program());
          }) == "This program runs code of its own, which computes with real numbers only.");
}
