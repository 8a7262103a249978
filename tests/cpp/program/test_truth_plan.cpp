#include "program/truth_plan.hpp"

#include "check.hpp"
#include "programs.hpp"

#include <limits>
#include <vector>

using namespace rtamt;
using programs::Builder;

namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

std::vector<Opcode> opcodes_of(const Program& program) {
    std::vector<Opcode> found;
    for (const Instruction& instruction : program.instructions)
        found.push_back(instruction.opcode);
    return found;
}

Stage stage_of(const Program& program, std::vector<std::size_t> columns,
               std::vector<Scan> scans = {}) {
    return {program, std::move(columns), std::move(scans)};
}

} // namespace

TEST_CASE("predicates are the outputs of the one part and the inputs of the other") {
    // always[0:4](x + y >= 1) or y > 2
    Builder builder;
    const auto x = builder.input();
    const auto y = builder.input();
    const auto sum = builder.pointwise(Opcode::add, x, y);
    const auto first = builder.pointwise(Opcode::holds_ge, sum, builder.constant(1));
    const auto all = builder.unary(Opcode::slide_min, first, 5, 4);
    const auto second = builder.pointwise(Opcode::holds_gt, y, builder.constant(2));
    builder.output(builder.pointwise(Opcode::max, all, builder.later(second, 4)));
    const std::vector<Stage> stages{stage_of(builder.program(), {1, 0})};
    const auto plan = truth_plan(stages, 2);
    REQUIRE(plan.has_value());
    CHECK(plan->pointwise);
    CHECK(opcodes_of(plan->numbers) == std::vector{Opcode::input, Opcode::input, Opcode::add,
                                                   Opcode::constant, Opcode::holds_ge,
                                                   Opcode::constant, Opcode::holds_gt});
    CHECK(plan->numbers.inputs == 2);
    CHECK(plan->numbers.instructions[0].n == 1); // the column of x
    CHECK(plan->numbers.instructions[1].n == 0);
    CHECK(plan->numbers.outputs == std::vector<std::uint32_t>{4, 6});
    REQUIRE(plan->joined.size() == 1);
    const Stage& joined = plan->joined.front();
    CHECK(opcodes_of(joined.program) ==
          std::vector{Opcode::input, Opcode::slide_min, Opcode::input, Opcode::shift, Opcode::max});
    CHECK(joined.program.inputs == 2);
    CHECK(joined.columns == std::vector<std::size_t>{0, 1});
    CHECK(joined.program.outputs == std::vector<std::uint32_t>{4});
}

TEST_CASE("a predicate of later samples has its lag again where it is read") {
    Builder builder;
    const auto most = builder.unary(Opcode::slide_max, builder.input(), 3, 2);
    const auto high = builder.pointwise(Opcode::holds_ge, most, builder.constant(1));
    builder.output(builder.pointwise(Opcode::neg, high));
    const std::vector<Stage> stages{stage_of(builder.program(), {0})};
    const auto plan = truth_plan(stages, 1);
    REQUIRE(plan.has_value());
    CHECK(!plan->pointwise);
    const auto& joined = plan->joined.front().program.instructions;
    REQUIRE(joined.size() == 3);
    CHECK(joined[1].opcode == Opcode::shift);
    CHECK(joined[1].n == 2);
    CHECK(joined[1].lag == 2);
    CHECK(joined[2].a == 1);
}

TEST_CASE("scans come after the predicates of all stages") {
    Builder first;
    first.output(first.pointwise(Opcode::holds_ge, first.input(), first.constant(1)));
    Builder last;
    const auto x = last.input();
    const auto always = last.input();
    const auto now = last.pointwise(Opcode::holds_gt, x, last.constant(2));
    last.output(last.pointwise(Opcode::min, always, now));
    const std::vector<Stage> stages{stage_of(first.program(), {0}, {{ScanKind::run_min, 0, 0}}),
                                    stage_of(last.program(), {0, 1})};
    const auto plan = truth_plan(stages, 1);
    REQUIRE(plan.has_value());
    CHECK(plan->numbers.outputs.size() == 2);
    CHECK(plan->joined[0].columns == std::vector<std::size_t>{0});
    CHECK(plan->joined[0].scans.size() == 1);
    CHECK(plan->joined[1].columns == std::vector<std::size_t>{2, 1});
}

TEST_CASE("a plan with a value that is no truth value stays whole") {
    Builder number;
    number.output(number.pointwise(Opcode::sub, number.input(), number.constant(1)));
    const std::vector<Stage> robustness{stage_of(number.program(), {0})};
    CHECK(!truth_plan(robustness, 1));

    Builder finite; // false where there is no sample, by -1
    const auto p = finite.pointwise(Opcode::holds_ge, finite.input(), finite.constant(1));
    finite.output(finite.unary(Opcode::shift, p, 1, 0, -1));
    const std::vector<Stage> before{stage_of(finite.program(), {0})};
    CHECK(!truth_plan(before, 1));

    Builder first;
    first.output(first.pointwise(Opcode::holds_ge, first.input(), first.constant(1)));
    Builder counted; // if always then 1 else x, as a number
    const auto chosen = counted.pointwise(Opcode::min, counted.input(), counted.constant(1));
    counted.output(counted.pointwise(Opcode::holds_ge, chosen, counted.constant(0)));
    const std::vector<Stage> of_a_scan{stage_of(first.program(), {0}, {{ScanKind::run_max, 0, 0}}),
                                       stage_of(counted.program(), {1})};
    CHECK(!truth_plan(of_a_scan, 1));

    const rtamt_kernel kernel{};
    Builder called;
    const auto own = called.call(kernel, {}, {called.input()}, 0);
    called.output(called.pointwise(Opcode::holds_ge, own, called.constant(inf)));
    const std::vector<Stage> code{stage_of(called.program(), {0})};
    CHECK(!truth_plan(code, 1));
}
