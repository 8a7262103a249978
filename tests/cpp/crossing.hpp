// Values that are read as numbers and as formulas, in the wiring of either time domain.
#pragma once

#include "check.hpp"
#include "programs.hpp"
#include "values/real.hpp"
#include "values/truth.hpp"

#include <cstddef>

namespace crossing {

std::size_t units(const auto& wiring) {
    std::size_t count = 0;
    wiring.units().each([&](const auto&) { ++count; });
    return count;
}

// Where numbers and formulas are of one domain, every value is in one place; else it is copied to
// the other sort once. `constants`: the units that a constant takes.
template <template <class> class Wiring>
void check(std::size_t constants) {
    using rtamt::Opcode;
    programs::Builder builder;
    const auto a = builder.input();
    const auto sum = builder.pointwise(Opcode::add, a, builder.constant(1));
    builder.output(builder.pointwise(Opcode::neg, sum));
    builder.output(builder.unary(Opcode::run_max, sum, 0, 0)).output(sum);
    CHECK(units(Wiring<rtamt::Real>(builder.program())) == 3 + constants);
    CHECK(units(Wiring<rtamt::Truth>(builder.program())) == 4 + constants);
}

} // namespace crossing
