// The functions of real numbers that programs apply at one instant: arithmetic and comparison.
//
// `partial` functions make NaN of some operands that are not NaN. A comparison is +inf where it
// holds and -inf where it does not.
#pragma once

#include "real.hpp"

#include <bit>
#include <cmath>
#include <cstdint>

namespace rtamt::functions {

struct Neg {
    static constexpr bool partial = false;
    static double of(double a) noexcept { return -a; }
};
struct Abs {
    static constexpr bool partial = false;
    static double of(double a) noexcept { return std::fabs(a); }
};
struct Sqrt {
    static constexpr bool partial = true;
    static double of(double a) noexcept { return std::sqrt(a); }
};
struct Exp {
    static constexpr bool partial = false;
    static double of(double a) noexcept { return std::exp(a); }
};
struct Ln {
    static constexpr bool partial = true;
    static double of(double a) noexcept { return std::log(a); }
};
struct Add {
    static constexpr bool partial = true;
    static double of(double a, double b) noexcept { return a + b; }
};
struct Sub {
    static constexpr bool partial = true;
    static double of(double a, double b) noexcept { return a - b; }
};
struct Mul {
    static constexpr bool partial = true;
    static double of(double a, double b) noexcept { return a * b; }
};
struct Div {
    static constexpr bool partial = true;
    static double of(double a, double b) noexcept { return a / b; }
};
struct Pow {
    static constexpr bool partial = true;
    static double of(double a, double b) noexcept { return std::pow(a, b); }
};
struct Log { // of a to the base b
    static constexpr bool partial = true;
    static double of(double a, double b) noexcept { return std::log(a) / std::log(b); }
};

// Of 0.0 and -0.0, which 1/x tells apart, 0.0 is the larger, whatever the order of the operands.
// One order answers the one and the other order the other; all other results have the same bits.
struct Max {
    static constexpr bool partial = false;
    static double of(double a, double b) noexcept {
        return std::bit_cast<double>(std::bit_cast<std::uint64_t>(Real::join(a, b)) &
                                     std::bit_cast<std::uint64_t>(Real::join(b, a)));
    }
};
struct Min {
    static constexpr bool partial = false;
    static double of(double a, double b) noexcept {
        return std::bit_cast<double>(std::bit_cast<std::uint64_t>(Real::meet(a, b)) |
                                     std::bit_cast<std::uint64_t>(Real::meet(b, a)));
    }
};

struct Greater {
    static bool holds(double a, double b) noexcept { return a > b; }
};
struct GreaterEqual {
    static bool holds(double a, double b) noexcept { return a >= b; }
};
struct Equal {
    static bool holds(double a, double b) noexcept { return a == b; }
};

// The robustness of a comparison that counts only whether it holds.
template <class Comparison>
struct Holds {
    static constexpr bool partial = false;
    static bool holds(double a, double b) noexcept { return Comparison::holds(a, b); }
    static double of(double a, double b) noexcept { return holds(a, b) ? infinity : -infinity; }
};
using HoldsGreater = Holds<Greater>;
using HoldsGreaterEqual = Holds<GreaterEqual>;
using HoldsEqual = Holds<Equal>;

} // namespace rtamt::functions
