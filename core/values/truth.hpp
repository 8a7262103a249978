// The domain of truth values of 64 traces: one bit each, 1 where the formula holds.
//
// Numbers become truth values in predicates. The numbers of 64 traces are 64 lanes of reals, so a
// program pays for 64 numbers up to its predicates and for one word from there on.
//
// Cost: one instruction of the machine an operation. Memory: a bit a trace.
#pragma once

#include "lanes.hpp"

#include <cstddef>
#include <cstdint>

namespace rtamt {

struct Truth {
    using Value = std::uint64_t;
    static constexpr std::size_t traces = 64;
    using Number = Lanes<traces>;

    static constexpr Value bottom = 0;
    static constexpr Value top = ~Value{0};
    static constexpr bool total = false;

    [[nodiscard]] static constexpr Value join(Value a, Value b) noexcept { return a | b; }
    [[nodiscard]] static constexpr Value meet(Value a, Value b) noexcept { return a & b; }
    [[nodiscard]] static constexpr Value neg(Value a) noexcept { return ~a; }
    [[nodiscard]] static constexpr bool undefined(Value /*a*/) noexcept { return false; }
    // A number used as a formula holds where it is positive.
    [[nodiscard]] static constexpr Value of(double x) noexcept { return x > 0 ? top : bottom; }

    template <class Predicate>
    [[nodiscard]] static Value test(const Number::Value& a, const Number::Value& b) noexcept {
        Value word = 0;
        for (std::size_t i = 0; i < traces; ++i)
            word |= Value{Predicate::holds(a.lane[i], b.lane[i])} << i;
        return word;
    }

    // A number used as a formula, and a formula used as a number: +inf where it holds, else -inf.
    [[nodiscard]] static Value formula(const Number::Value& a) noexcept {
        Value word = 0;
        for (std::size_t i = 0; i < traces; ++i)
            word |= Value{a.lane[i] > 0} << i;
        return word;
    }
    [[nodiscard]] static Number::Value number(Value word) noexcept {
        return Number::each(
            [=](std::size_t i) { return ((word >> i) & 1U) != 0 ? infinity : -infinity; });
    }
};

static_assert(ValueDomain<Truth> && !UniformDomain<Truth>);

} // namespace rtamt
