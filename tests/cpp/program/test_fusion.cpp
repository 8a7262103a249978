#include "program/fusion.hpp"

#include "check.hpp"
#include "programs.hpp"

using programs::Builder;
using rtamt::fused;
using rtamt::Fusion;
using rtamt::Opcode;

namespace {

// a + b >= -2 and a - b <= 3, in one chain.
struct Both {
    Builder builder;
    std::uint32_t a = builder.input();
    std::uint32_t b = builder.input();
    std::uint32_t sum = builder.pointwise(Opcode::add, a, b);
    std::uint32_t low = builder.pointwise(Opcode::sub, sum, builder.constant(-2));
    std::uint32_t difference = builder.pointwise(Opcode::sub, a, b);
    std::uint32_t high = builder.pointwise(Opcode::sub, builder.constant(3), difference);
    std::uint32_t least = builder.pointwise(Opcode::min, low, high);
};

} // namespace

TEST_CASE("what is read within a chain alone belongs to it") {
    Both both;
    both.builder.output(both.least);
    const Fusion fusion = fused(both.builder.program());
    for (const std::uint32_t i : {both.sum, both.low, both.difference, both.high, both.least}) {
        CHECK((fusion.roots[i] == both.least && fusion.chained[i] && fusion.guarded[i]));
    }
    CHECK((!fusion.chained[both.a] && fusion.inside(both.low) && !fusion.inside(both.least)));
}

TEST_CASE("outputs and what several units read have a register") {
    Both both;
    both.builder.output(both.least).output(both.difference);
    const auto window = both.builder.unary(Opcode::slide_min, both.low, 5, 0);
    both.builder.output(window);
    const Fusion fusion = fused(both.builder.program());
    CHECK((fusion.roots[both.difference] == both.difference && !fusion.chained[both.difference]));
    CHECK((fusion.roots[both.sum] == both.low && fusion.roots[both.low] == both.low));
    CHECK((fusion.roots[both.high] == both.least && fusion.roots[window] == window));
}

TEST_CASE("a chain with state behind it does not become guarded") {
    Builder builder;
    const auto a = builder.input();
    const auto sum = builder.pointwise(Opcode::add, a, builder.input());
    const auto window = builder.unary(Opcode::slide_min, a, 5, 0);
    const auto least = builder.pointwise(Opcode::min, sum, window);
    builder.output(builder.pointwise(Opcode::neg, least));
    const Fusion fusion = fused(builder.program());
    CHECK((fusion.guarded[sum] && fusion.roots[sum] == sum));
    CHECK((!fusion.guarded[least] && !fusion.guarded[window] && fusion.chained[least]));
}

TEST_CASE("what a guarded chain reads is guarded") {
    Builder builder;
    const auto a = builder.input();
    const auto shared = builder.pointwise(Opcode::exp, a);
    const auto sum = builder.pointwise(Opcode::add, a, builder.input());
    const auto least = builder.pointwise(Opcode::min, sum, shared);
    builder.output(least).output(builder.pointwise(Opcode::neg, shared));
    const Fusion fusion = fused(builder.program());
    CHECK((fusion.roots[sum] == least && fusion.guarded[least] && fusion.guarded[shared]));
}

TEST_CASE("nothing is fused where the pass is left out") {
    Both both;
    both.builder.plain().output(both.least);
    const Fusion fusion = fused(both.builder.program());
    CHECK((!fusion.chained[both.sum] && fusion.roots[both.sum] == both.sum));
    CHECK(fusion.guarded == both.builder.program().guarded());
}
