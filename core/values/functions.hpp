// The functions of real numbers that programs apply at one instant: arithmetic and comparison.
//
// `partial` functions make NaN of some operands that are not NaN. A comparison is +inf where it
// holds and -inf where it does not.
//
// Equal operands have equal results: -0.0 is a divisor and a base like 0.0. So which of two zeros a
// max or min returns changes nothing that is computed from it.
#pragma once

#include "real.hpp"

#include <cmath>

namespace rtamt::functions {

[[nodiscard]] inline double unsigned_zero(double a) noexcept {
    return a + 0.0; // -0.0 + 0.0 is 0.0
}

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
    static double of(double a, double b) noexcept { return a / unsigned_zero(b); }
};
struct Pow {
    static constexpr bool partial = true;
    static double of(double a, double b) noexcept { return std::pow(unsigned_zero(a), b); }
};
struct Log { // of a to the base b
    static constexpr bool partial = true;
    static double of(double a, double b) noexcept { return std::log(a) / std::log(b); }
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
