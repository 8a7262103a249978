// Random programs over two inputs, for either time domain.
#pragma once

#include "discrete/oracle.hpp"
#include "programs.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace programs {

// A random program over two inputs: any opcode over anything so far, delays where lags differ.
inline Program random_program(oracle::Random& random, int size,
                              rtamt::Domain domain = rtamt::Domain::discrete) {
    const bool dense = domain == rtamt::Domain::dense;
    const std::int64_t least = dense ? 0 : 1; // width: ticks from the first to the last, or samples
    const std::int64_t few = least + 5;
    const std::int64_t many = dense ? 30 : 40;
    Builder builder;
    std::vector<std::uint32_t> known{builder.input(), builder.input(),
                                     builder.constant(random.number(5))};
    const auto pick = [&] {
        return known[static_cast<std::size_t>(
            random.between(0, static_cast<std::int64_t>(known.size()) - 1))];
    };
    const auto constant = [&](std::uint32_t a) {
        return builder.program().instructions[a].opcode == Opcode::constant;
    };
    for (int i = 0; i < size; ++i) {
        const auto opcode =
            static_cast<Opcode>(random.between(2, static_cast<std::int64_t>(Opcode::until)));
        std::uint32_t a = pick();
        std::uint32_t b = pick();
        const auto& info = rtamt::info(opcode);
        if (info.operands == 2 && !constant(a) && !constant(b)) {
            const std::int64_t apart = builder.lag(a) - builder.lag(b);
            if (apart > 0) b = builder.later(b, apart);
            if (apart < 0) a = builder.later(a, -apart);
        }
        if (info.pointwise) {
            known.push_back(
                builder.pointwise(opcode, a, info.operands == 2 ? b : rtamt::no_operand));
            continue;
        }
        const std::int64_t width = random.between(least, random.chance(20) ? many : few);
        if (random.chance(15)) { // windows of the past alone
            const auto sum = random.chance(70) ? Opcode::slide_sum : Opcode::run_sum;
            known.push_back(builder.unary(sum, a, width, builder.lag(a)));
            continue;
        }
        const std::int64_t operand_lag =
            constant(a) && info.operands == 2 ? builder.lag(b) : builder.lag(a);
        const std::int64_t lag =
            std::max<std::int64_t>(0, operand_lag + random.between(-1, width + 1 - least));
        const double absent = random.number(30);
        known.push_back(info.operands == 2 ? builder.binary(opcode, a, b, width, lag)
                                           : builder.unary(opcode, a, width, lag, absent));
    }
    builder.output(known.back());
    builder.output(pick());
    return builder.program();
}

} // namespace programs
