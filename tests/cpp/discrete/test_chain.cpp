#include "discrete/chain.hpp"

#include "programs.hpp"
#include "random_programs.hpp"
#include "ways.hpp"

#include <bit>
#include <cmath>
#include <limits>

using programs::Builder;
using rtamt::Opcode;
using rtamt::Program;
using ways::Random;
using ways::Signal;

namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

std::vector<std::uint64_t> bits(const std::vector<Signal>& signals) {
    std::vector<std::uint64_t> bits;
    for (const Signal& signal : signals) {
        for (const double value : signal)
            bits.push_back(std::bit_cast<std::uint64_t>(value));
    }
    return bits;
}

// A program of operations at one instant alone: most of it is one chain.
Program pointwise(Random& random, int size) {
    constexpr Opcode opcodes[] = {
        Opcode::neg, Opcode::abs, Opcode::sqrt,     Opcode::add,      Opcode::sub,
        Opcode::mul, Opcode::div, Opcode::min,      Opcode::max,      Opcode::holds_gt,
        Opcode::min, Opcode::max, Opcode::holds_ge, Opcode::holds_eq, Opcode::at_least,
        Opcode::min, Opcode::exp, Opcode::max,      Opcode::sub,      Opcode::sub};
    Builder builder;
    std::vector<std::uint32_t> known{builder.input(), builder.input(), builder.constant(0.0),
                                     builder.constant(random.number(5))};
    const auto pick = [&](std::int64_t of) {
        const auto last = static_cast<std::int64_t>(known.size()) - 1;
        return known[static_cast<std::size_t>(
            random.between(std::max<std::int64_t>(0, last + 1 - of), last))];
    };
    for (int i = 0; i < size; ++i) {
        const Opcode opcode = opcodes[random.between(0, std::size(opcodes) - 1)];
        const auto b = rtamt::info(opcode).operands == 2 ? pick(100) : rtamt::no_operand;
        known.push_back(random.chance(50) || b == rtamt::no_operand
                            ? builder.pointwise(opcode, pick(2), b)
                            : builder.pointwise(opcode, b, pick(2)));
    }
    return builder.output(known.back()).program();
}

// Checks the bits, or the failure, against those of instructions one by one; returns whether it
// fails.
bool same_as_single(Program program, const std::vector<Signal>& columns, std::size_t count) {
    std::vector<Signal> outputs;
    std::vector<Signal> expected;
    const auto failure = ways::offline(program, columns, count, outputs);
    program.without = 3;
    const auto wanted = ways::offline(program, columns, count, expected);
    CHECK(failure.has_value() == wanted.has_value());
    if (!failure || !wanted) {
        CHECK(bits(outputs) == bits(expected));
        return false;
    }
    CHECK((failure->instruction == wanted->instruction));
    CHECK(failure->sample == wanted->sample);
    return true;
}

} // namespace

TEST_CASE("chains give the bits, and the failures, of instructions one by one") {
    Random random(31);
    int failed = 0;
    for (int round = 0; round < 600; ++round) {
        const Program program = pointwise(random, static_cast<int>(random.between(1, 25)));
        const auto count = static_cast<std::size_t>(random.between(1, 100));
        std::vector<Signal> columns{random.signal(count, 0), random.signal(count, 0)};
        for (Signal& column : columns) {
            for (double& value : column) {
                if (random.chance(5)) value = random.chance(50) ? -0.0 : 0.0;
                if (random.chance(1)) value = random.chance(50) ? inf : -inf;
            }
        }
        failed += static_cast<int>(same_as_single(program, columns, count));
    }
    CHECK((failed > 50 && failed < 550));
}

TEST_CASE("a chain names the member that is undefined, wherever NaN would end") {
    Builder builder;
    const auto a = builder.input();
    const auto b = builder.input();
    const auto sum = builder.pointwise(Opcode::add, a, b);
    const auto margin = builder.pointwise(Opcode::sub, sum, builder.constant(1));
    builder.output(builder.pointwise(Opcode::max, margin, b));
    for (const std::size_t count : {1U, 31U, 32U, 90U, 5000U}) {
        std::vector<Signal> columns{Signal(count, 1.0), Signal(count, 2.0)};
        columns[0].back() = inf;
        columns[1].back() = -inf;
        std::vector<Signal> outputs;
        const auto failure = ways::offline(builder.program(), columns, count, outputs);
        REQUIRE(failure.has_value());
        CHECK(failure->instruction == sum);
        CHECK(failure->sample == static_cast<std::int64_t>(count) - 1);
    }
}

TEST_CASE("sums and differences are compared with limits in one step, and joined in the next") {
    Builder builder;
    const auto a = builder.input();
    const auto b = builder.input();
    const auto three = builder.constant(3);
    std::vector<std::uint32_t> members;
    const auto member = [&](Opcode opcode, std::uint32_t x, std::uint32_t y) {
        members.push_back(builder.pointwise(opcode, x, y));
        return members.back();
    };
    std::uint32_t found = 0;
    for (const Opcode join : {Opcode::neg, Opcode::min, Opcode::max}) {
        for (const Opcode inner : {Opcode::add, Opcode::sub}) {
            for (const bool under : {false, true}) {
                const auto value = member(inner, a, b);
                const auto term =
                    under ? member(Opcode::sub, three, value) : member(Opcode::sub, value, three);
                if (join == Opcode::neg) {
                    found = members.size() == 2 ? term : member(Opcode::min, term, found);
                } else {
                    found = member(join, found, term);
                }
            }
        }
    }
    const Program program = builder.output(found).program();
    std::vector<rtamt::discrete::Action> actions;
    const auto code = rtamt::discrete::chain_code(program, rtamt::fused(program), members);
    for (const auto& step : code.steps)
        actions.push_back(step.action);
    using enum rtamt::discrete::Action;
    CHECK(actions == std::vector{sum_over, store, sum_under, min, store, difference_over, min,
                                 store, difference_under, min, min_sum_over, min_sum_under,
                                 min_difference_over, min_difference_under, max_sum_over,
                                 max_sum_under, max_difference_over, max_difference_under});
    CHECK((code.single_steps.size() > code.steps.size()));
}

TEST_CASE("terms of limits give the bits, and the failures, of instructions one by one") {
    Random random(33);
    int failed = 0;
    for (int round = 0; round < 400; ++round) {
        Builder builder;
        const std::uint32_t inputs[] = {builder.input(), builder.input()};
        std::uint32_t found = rtamt::no_operand;
        for (auto terms = random.between(1, 4); terms-- > 0;) {
            const auto limit = builder.constant(random.chance(10) ? inf : random.number(3));
            const auto value =
                builder.pointwise(random.chance(50) ? Opcode::add : Opcode::sub,
                                  inputs[random.between(0, 1)], inputs[random.between(0, 1)]);
            const auto term = random.chance(50) ? builder.pointwise(Opcode::sub, value, limit)
                                                : builder.pointwise(Opcode::sub, limit, value);
            const Opcode join = random.chance(50) ? Opcode::min : Opcode::max;
            if (found == rtamt::no_operand) {
                found = random.chance(30) ? builder.pointwise(Opcode::neg, term) : term;
            } else if (random.chance(80)) {
                found = builder.pointwise(join, found, term);
            } else {
                found = builder.pointwise(join, term, found);
            }
        }
        const Program program = builder.output(found).program();
        const auto count = static_cast<std::size_t>(random.between(1, 150));
        std::vector<Signal> columns(2);
        for (Signal& column : columns) {
            for (std::size_t i = 0; i < count; ++i) {
                const double near[] = {1.0, -1.0, 0.0, -0.0, 2.0, random.number(5)};
                column.push_back(near[random.between(0, std::size(near) - 1)]);
                if (random.chance(1)) column.back() = random.chance(50) ? inf : -inf;
            }
        }
        failed += static_cast<int>(same_as_single(program, columns, count));
    }
    CHECK((failed > 40 && failed < 360));
}

TEST_CASE("differences from constants are joined in one step, with the bits of two") {
    Builder builder;
    const auto x = builder.input();
    const auto y = builder.input();
    const auto one = builder.constant(1);
    const auto low = builder.pointwise(Opcode::sub, x, one);
    const auto high = builder.pointwise(Opcode::sub, one, y);
    const auto both = builder.pointwise(Opcode::min, low, high);
    const auto other = builder.pointwise(Opcode::sub, y, builder.constant(-1));
    builder.output(builder.pointwise(Opcode::max, both, other));
    Program program = builder.program();

    const std::vector<std::uint32_t> members{low, high, both, other, program.outputs[0]};
    std::vector<rtamt::discrete::Action> found;
    for (const auto& step :
         rtamt::discrete::chain_code(program, rtamt::fused(program), members).steps)
        found.push_back(step.action);
    using enum rtamt::discrete::Action;
    CHECK(found == std::vector{sub_both, min_difference, max_difference});

    Random random(32);
    for (const std::size_t count : {1U, 31U, 32U, 33U, 400U}) {
        std::vector<Signal> columns(2);
        for (Signal& column : columns) {
            for (std::size_t i = 0; i < count; ++i) {
                const double near[] = {1.0, 1.0, -1.0, 0.0, -0.0, 2.0, inf, -inf};
                column.push_back(near[random.between(0, std::size(near) - 1)]);
            }
        }
        std::vector<Signal> outputs;
        std::vector<Signal> expected;
        program.without = 0;
        CHECK(!ways::offline(program, columns, count, outputs));
        program.without = 3;
        CHECK(!ways::offline(program, columns, count, expected));
        CHECK(bits(outputs) == bits(expected));
    }
}
