#include "program/sorts.hpp"

#include "check.hpp"
#include "programs.hpp"

using programs::Builder;
using rtamt::Opcode;
using rtamt::Sort;

TEST_CASE("predicates take numbers and give formulas") {
    Builder builder;
    const auto a = builder.input();
    const auto three = builder.constant(3);
    const auto sum = builder.pointwise(Opcode::add, a, three);
    const auto holds = builder.pointwise(Opcode::holds_gt, sum, three);
    const auto always = builder.unary(Opcode::slide_min, holds, 5, 4);
    builder.output(always);
    const auto sorts = rtamt::sorts(builder.program());
    CHECK((sorts[a] == Sort::number && sorts[three] == Sort::number && sorts[sum] == Sort::number));
    CHECK((sorts[holds] == Sort::formula && sorts[always] == Sort::formula));
    CHECK(taken(builder.program().instructions[holds], Sort::formula) == Sort::number);
    CHECK(taken(builder.program().instructions[always], Sort::formula) == Sort::formula);
}

TEST_CASE("what works on either is a number where a number is wanted") {
    Builder builder;
    const auto a = builder.input();
    const auto b = builder.input();
    const auto least = builder.pointwise(Opcode::min, a, b);
    const auto difference = builder.pointwise(Opcode::sub, least, builder.constant(1));
    builder.output(difference).output(builder.unary(Opcode::run_max, b, 0, 0));
    const auto sorts = rtamt::sorts(builder.program());
    CHECK((sorts[least] == Sort::number && sorts[a] == Sort::number && sorts[b] == Sort::number));
    CHECK(sorts.back() == Sort::formula);
}

TEST_CASE("an input that only formulas read is a formula") {
    Builder builder;
    const auto p = builder.input();
    const auto q = builder.input();
    builder.output(builder.binary(Opcode::until, builder.pointwise(Opcode::neg, p), q, 4, 3));
    for (const Sort sort : rtamt::sorts(builder.program()))
        CHECK(sort == Sort::formula);
}

TEST_CASE("an input that two instructions read has one sort") {
    rtamt::Program program;
    program.inputs = 1;
    const rtamt::Instruction input{Opcode::input, rtamt::no_operand, rtamt::no_operand, 0, 0, 0};
    program.instructions = {input, input};
    program.instructions.push_back({Opcode::abs, 0, rtamt::no_operand, 0, 0, 0});
    program.instructions.push_back({Opcode::neg, 1, rtamt::no_operand, 0, 0, 0});
    program.outputs = {2, 3};
    const auto sorts = rtamt::sorts(program);
    CHECK((sorts[0] == Sort::number && sorts[1] == Sort::number && sorts[3] == Sort::formula));
}
