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
#include <limits>
#include <numbers>

namespace rtamt::functions {

inline constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

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

// Trigonometry in radians, as in C: of an infinite angle it is undefined.
struct Sin {
    static constexpr bool partial = true;
    static double of(double a) noexcept { return std::sin(a); }
};
struct Cos {
    static constexpr bool partial = true;
    static double of(double a) noexcept { return std::cos(a); }
};
struct Tan {
    static constexpr bool partial = true;
    static double of(double a) noexcept { return std::tan(a); }
};
struct Asin {
    static constexpr bool partial = true;
    static double of(double a) noexcept { return std::asin(a); }
};
struct Acos {
    static constexpr bool partial = true;
    static double of(double a) noexcept { return std::acos(a); }
};
struct Atan {
    static constexpr bool partial = false;
    static double of(double a) noexcept { return std::atan(a); }
};
struct Atan2 { // of the point (b, a)
    static constexpr bool partial = false;
    static double of(double a, double b) noexcept {
        return std::atan2(unsigned_zero(a), unsigned_zero(b));
    }
};
struct Hypot {
    static constexpr bool partial = false;
    static double of(double a, double b) noexcept { return std::hypot(a, b); }
};
struct Sinh {
    static constexpr bool partial = false;
    static double of(double a) noexcept { return std::sinh(a); }
};
struct Cosh {
    static constexpr bool partial = false;
    static double of(double a) noexcept { return std::cosh(a); }
};
struct Tanh {
    static constexpr bool partial = false;
    static double of(double a) noexcept { return std::tanh(a); }
};
struct Degrees {
    static constexpr bool partial = false;
    static double of(double a) noexcept { return a * (180.0 / std::numbers::pi); }
};
struct Radians {
    static constexpr bool partial = false;
    static double of(double a) noexcept { return a * (std::numbers::pi / 180.0); }
};

struct Floor {
    static constexpr bool partial = false;
    static double of(double a) noexcept { return std::floor(a); }
};
struct Ceil {
    static constexpr bool partial = false;
    static double of(double a) noexcept { return std::ceil(a); }
};
struct Round { // halves away from zero
    static constexpr bool partial = false;
    static double of(double a) noexcept { return std::round(a); }
};
struct Sign {
    static constexpr bool partial = false;
    static double of(double a) noexcept {
        return static_cast<double>(a > 0) - static_cast<double>(a < 0);
    }
};
struct Mod { // with the sign of the divisor
    static constexpr bool partial = true;
    static double of(double a, double b) noexcept {
        const double rest = std::fmod(a, b);
        return rest != 0 && (rest < 0) != (b < 0) ? rest + b : rest;
    }
};
struct AtLeast { // a, which is undefined below b
    static constexpr bool partial = true;
    static double of(double a, double b) noexcept { return a >= b ? a : undefined; }
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
