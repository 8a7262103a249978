#include "program/liveness.hpp"

#include "check.hpp"
#include "programs.hpp"

using programs::Builder;
using rtamt::no_register;
using rtamt::Opcode;
using rtamt::Registers;

namespace {

Registers of(const rtamt::Program& program) {
    return rtamt::registers(program, rtamt::fused(program));
}

// Windows one after another: each reads the one before alone.
rtamt::Program row(std::size_t length, bool plain) {
    Builder builder;
    auto value = builder.input();
    for (std::size_t i = 0; i < length; ++i)
        value = builder.unary(Opcode::slide_min, value, 3, 0);
    builder.output(value);
    return plain ? builder.plain().program() : builder.program();
}

} // namespace

TEST_CASE("a value that nothing reads any more gives its register away") {
    CHECK(of(row(100, false)).count == 3); // one of them is the output's
    CHECK(of(row(100, true)).count == 101);
}

TEST_CASE("a result is never in the register of an operand") {
    const rtamt::Program program = row(100, false);
    const Registers registers = of(program);
    for (std::size_t i = 1; i < program.instructions.size(); ++i)
        CHECK(registers.rows[i] != registers.rows[i - 1]);
}

TEST_CASE("outputs keep their registers") {
    Builder builder;
    auto value = builder.input();
    for (int i = 0; i < 10; ++i) {
        value = builder.unary(Opcode::slide_min, value, 3, 0);
        builder.output(value);
    }
    CHECK(of(builder.program()).count == 11);
}

TEST_CASE("guarded units come first") {
    Builder builder;
    const auto a = builder.input();
    const auto free = builder.unary(Opcode::slide_max, a, 2, 0); // after all that follows
    const auto root = builder.pointwise(Opcode::sqrt, builder.unary(Opcode::slide_min, a, 2, 0));
    const auto other = builder.pointwise(Opcode::exp, root);
    builder.output(builder.pointwise(Opcode::hypot, free, other));
    const Registers registers = of(builder.program());
    CHECK(registers.rows[free] != registers.rows[root]);
}

TEST_CASE("a constant has a register where its slots are read") {
    Builder builder;
    const auto a = builder.input();
    const auto once = builder.constant(1);
    const auto spread = builder.constant(2);
    builder.output(builder.pointwise(Opcode::pow, a, once));
    builder.output(builder.unary(Opcode::slide_min, spread, 3, 0));
    const Registers registers = of(builder.program());
    CHECK((registers.rows[once] == no_register && registers.rows[spread] != no_register));
}
