// Bounds of a number that is not known exactly, and what functions make of them.
//
// An interval extension encloses every result for operands within their bounds. Operations that
// IEEE 754 rounds correctly are monotone, so their bounds are results at corners and are attained.
// A function of the C library is off by an unknown bit or two: its bounds are widened by four units
// in the last place. Corners that are undefined although other operands are not: inf - inf is the
// infinite end, 0 * inf is 0, and finite / inf is 0. Operands outside the domain of a function are
// cut off; where nothing is left, the result is undefined.
#pragma once

#include "functions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <limits>
#include <numbers>

namespace rtamt {

struct Bounds {
    double lower;
    double upper;

    [[nodiscard]] friend bool operator==(const Bounds&, const Bounds&) = default;
    [[nodiscard]] bool holds_zero() const noexcept { return lower <= 0 && upper >= 0; }
};

namespace bounds {

inline constexpr Bounds anything{-infinity, infinity};
inline constexpr Bounds nothing{std::numeric_limits<double>::quiet_NaN(),
                                std::numeric_limits<double>::quiet_NaN()};

[[nodiscard]] inline double otherwise(double value, double instead) noexcept {
    return std::isnan(value) ? instead : value;
}

[[nodiscard]] inline Bounds widened(Bounds a) noexcept {
    for (int i = 0; i < 4; ++i)
        a = {std::nextafter(a.lower, -infinity), std::nextafter(a.upper, infinity)};
    return a;
}

[[nodiscard]] inline Bounds not_negative(Bounds a) noexcept {
    return {std::max(a.lower, 0.0), a.upper};
}

// The hull of f at the four corners, `instead` where f is undefined there.
template <class Function>
[[nodiscard]] Bounds corners(Function&& f, Bounds a, Bounds b, double instead) noexcept {
    const std::array<double, 4> ends{
        otherwise(f(a.lower, b.lower), instead), otherwise(f(a.lower, b.upper), instead),
        otherwise(f(a.upper, b.lower), instead), otherwise(f(a.upper, b.upper), instead)};
    const auto [low, high] = std::ranges::minmax_element(ends);
    return {*low, *high};
}

[[nodiscard]] inline Bounds extension(functions::Neg /*f*/, Bounds a) noexcept {
    return {-a.upper, -a.lower};
}

[[nodiscard]] inline Bounds extension(functions::Abs /*f*/, Bounds a) noexcept {
    const double most = std::max(std::fabs(a.lower), std::fabs(a.upper));
    return {a.holds_zero() ? 0.0 : std::min(std::fabs(a.lower), std::fabs(a.upper)), most};
}

[[nodiscard]] inline Bounds extension(functions::Sqrt /*f*/, Bounds a) noexcept {
    if (a.upper < 0) return nothing;
    return {std::sqrt(std::max(a.lower, 0.0)), std::sqrt(a.upper)};
}

[[nodiscard]] inline Bounds extension(functions::Exp /*f*/, Bounds a) noexcept {
    return not_negative(widened({std::exp(a.lower), std::exp(a.upper)}));
}

[[nodiscard]] inline Bounds extension(functions::Ln /*f*/, Bounds a) noexcept {
    if (a.upper < 0) return nothing;
    return widened({std::log(std::max(a.lower, 0.0)), std::log(a.upper)});
}

[[nodiscard]] inline Bounds extension(functions::Add /*f*/, Bounds a, Bounds b) noexcept {
    return {otherwise(a.lower + b.lower, -infinity), otherwise(a.upper + b.upper, infinity)};
}

[[nodiscard]] inline Bounds extension(functions::Sub /*f*/, Bounds a, Bounds b) noexcept {
    return {otherwise(a.lower - b.upper, -infinity), otherwise(a.upper - b.lower, infinity)};
}

[[nodiscard]] inline Bounds extension(functions::Mul /*f*/, Bounds a, Bounds b) noexcept {
    return corners(functions::Mul::of, a, b, 0.0);
}

[[nodiscard]] inline Bounds extension(functions::Div /*f*/, Bounds a, Bounds b) noexcept {
    if (b.holds_zero()) return anything;
    return corners(functions::Div::of, a, b, 0.0);
}

// x^n for one whole number n: rising, falling, or falling and then rising.
[[nodiscard]] inline Bounds power(Bounds a, double n) noexcept {
    const bool even = std::fmod(n, 2.0) == 0;
    const bool across = a.lower < 0 && a.upper >= 0;
    if (!even && n < 0 && across) return anything; // a pole
    const double low = std::pow(a.lower, n);
    const double high = std::pow(a.upper, n);
    Bounds result = widened({std::min(low, high), std::max(low, high)});
    if (!even) return result;
    if (across && n > 0) result.lower = 0.0;
    if (across && n < 0) result.upper = infinity;
    return not_negative(result);
}

[[nodiscard]] inline Bounds extension(functions::Pow /*f*/, Bounds a, Bounds b) noexcept {
    if (b.lower == 0 && b.upper == 0) return {1.0, 1.0};
    if (a.lower < 0) {
        if (b.lower != b.upper) return anything; // whole exponents between others
        if (std::isinf(b.lower)) return {0.0, infinity};
        if (std::trunc(b.lower) == b.lower) return power(a, b.lower);
        if (std::isinf(a.lower)) return {0.0, infinity}; // (-inf)^y is defined for every y
        if (a.upper < 0) return nothing;
        a.lower = 0.0;
    }
    const bool odd = b.lower != b.upper || std::fabs(std::fmod(b.lower, 2.0)) == 1;
    if (a.lower == 0 && b.lower < 0 && odd) return anything; // a pole: odd powers of -0.0 are -inf
    // x^y = exp(y ln x) is bilinear in y and ln x, so its extrema are at corners.
    return not_negative(widened(corners(functions::Pow::of, a, b, 1.0)));
}

// The quotient of two logarithms, each exact where its operand is.
[[nodiscard]] inline Bounds extension(functions::Log /*f*/, Bounds a, Bounds b) noexcept {
    const auto ln = [](Bounds x) {
        return x.lower == x.upper ? Bounds{std::log(x.lower), std::log(x.lower)}
                                  : extension(functions::Ln{}, x);
    };
    const Bounds above = ln(a);
    const Bounds below = ln(b);
    if (std::isnan(above.lower) || std::isnan(below.lower)) return nothing;
    return extension(functions::Div{}, above, below);
}

template <class F>
[[nodiscard]] Bounds extension(functions::Holds<F> f, Bounds a, Bounds b) noexcept {
    return {f.of(a.lower, b.upper), f.of(a.upper, b.lower)};
}

[[nodiscard]] inline Bounds extension(functions::HoldsEqual f, Bounds a, Bounds b) noexcept {
    const bool possible = a.lower <= b.upper && b.lower <= a.upper;
    const bool certain = a.lower == a.upper && b.lower == b.upper && f.holds(a.lower, b.lower);
    return {certain ? infinity : -infinity, possible ? infinity : -infinity};
}

// ---- trigonometry and its relatives
// --------------------------------------------------------------

[[nodiscard]] inline Bounds limited(Bounds a, Bounds to) noexcept {
    return {std::max(a.lower, to.lower), std::min(a.upper, to.upper)};
}

[[nodiscard]] inline bool finite(Bounds a) noexcept {
    return std::isfinite(a.lower) && std::isfinite(a.upper);
}

// Whether one of the points offset + k * period lies within bounds; also where rounding may hide
// it.
[[nodiscard]] inline bool reaches(Bounds a, double offset, double period) noexcept {
    const double from = (a.lower - offset) / period;
    const double to = (a.upper - offset) / period;
    const double slack = 0x1p-48 * (1 + std::max(std::fabs(from), std::fabs(to)));
    return std::ceil(from - slack) <= to + slack;
}

// Of a wave between -1 and 1 with its crests and troughs at these points.
template <class Function>
[[nodiscard]] Bounds wave(Function f, Bounds a, double crest, double trough) noexcept {
    constexpr Bounds all{-1, 1};
    constexpr double turn = 2 * std::numbers::pi;
    if (!finite(a)) return all;
    const Bounds of{f.of(a.lower), f.of(a.upper)};
    const Bounds ends =
        limited(widened({std::min(of.lower, of.upper), std::max(of.lower, of.upper)}), all);
    return {reaches(a, trough, turn) ? -1 : ends.lower, reaches(a, crest, turn) ? 1 : ends.upper};
}

[[nodiscard]] inline Bounds extension(functions::Sin f, Bounds a) noexcept {
    return wave(f, a, std::numbers::pi / 2, -std::numbers::pi / 2);
}

[[nodiscard]] inline Bounds extension(functions::Cos f, Bounds a) noexcept {
    return wave(f, a, 0, std::numbers::pi);
}

[[nodiscard]] inline Bounds extension(functions::Tan f, Bounds a) noexcept {
    if (!finite(a) || reaches(a, std::numbers::pi / 2, std::numbers::pi)) return anything;
    return widened({f.of(a.lower), f.of(a.upper)});
}

[[nodiscard]] inline Bounds extension(functions::Asin f, Bounds a) noexcept {
    if (a.upper < -1 || a.lower > 1) return nothing;
    a = limited(a, {-1, 1});
    return widened({f.of(a.lower), f.of(a.upper)});
}

[[nodiscard]] inline Bounds extension(functions::Acos f, Bounds a) noexcept {
    if (a.upper < -1 || a.lower > 1) return nothing;
    a = limited(a, {-1, 1});
    return not_negative(widened({f.of(a.upper), f.of(a.lower)}));
}

[[nodiscard]] inline Bounds extension(functions::Atan f, Bounds a) noexcept {
    return widened({f.of(a.lower), f.of(a.upper)});
}

// The angle jumps where the point crosses the negative axis.
[[nodiscard]] inline Bounds extension(functions::Atan2 f, Bounds a, Bounds b) noexcept {
    constexpr Bounds all{-std::numbers::pi, std::numbers::pi};
    if (b.lower < 0 && a.lower < 0 && a.upper >= 0) return all;
    return limited(widened(corners(f.of, a, b, 0.0)), all);
}

[[nodiscard]] inline Bounds extension(functions::Hypot f, Bounds a, Bounds b) noexcept {
    a = extension(functions::Abs{}, a);
    b = extension(functions::Abs{}, b);
    return not_negative(widened({f.of(a.lower, b.lower), f.of(a.upper, b.upper)}));
}

[[nodiscard]] inline Bounds extension(functions::Sinh f, Bounds a) noexcept {
    return widened({f.of(a.lower), f.of(a.upper)});
}

[[nodiscard]] inline Bounds extension(functions::Cosh f, Bounds a) noexcept {
    a = extension(functions::Abs{}, a);
    return limited(widened({f.of(a.lower), f.of(a.upper)}), {1, infinity});
}

[[nodiscard]] inline Bounds extension(functions::Tanh f, Bounds a) noexcept {
    return limited(widened({f.of(a.lower), f.of(a.upper)}), {-1, 1});
}

// ---- rounding and remainders
// -----------------------------------------------------------------------

template <class Function>
concept Rising =
    std::same_as<Function, functions::Degrees> || std::same_as<Function, functions::Radians> ||
    std::same_as<Function, functions::Floor> || std::same_as<Function, functions::Ceil> ||
    std::same_as<Function, functions::Round> || std::same_as<Function, functions::Sign>;

template <Rising Function>
[[nodiscard]] Bounds extension(Function f, Bounds a) noexcept {
    return {f.of(a.lower), f.of(a.upper)};
}

// Where x lies between two multiples of m > 0: fmod is exact, and negative numbers count from
// above.
[[nodiscard]] inline double phase(double x, double m) noexcept {
    const double rest = std::fmod(x, m);
    return x < 0 && rest == 0 ? -m : rest;
}

[[nodiscard]] inline Bounds extension(functions::Mod f, Bounds a, Bounds b) noexcept {
    if (b.upper < 0) {
        const Bounds mirrored =
            extension(f, Bounds{-a.upper, -a.lower}, Bounds{-b.upper, -b.lower});
        return {-mirrored.upper, -mirrored.lower};
    }
    if ((b.lower == 0 && b.upper == 0) || (a.lower == a.upper && std::isinf(a.lower)))
        return nothing;
    if (b.lower <= 0) return {std::min(b.lower, 0.0), b.upper};
    if (a.lower >= 0 && a.upper < b.lower) return a;
    const double m = b.lower;
    const bool same_side = (a.lower < 0) == (a.upper < 0);
    if (m == b.upper && finite(a) && same_side && a.upper - a.lower < m &&
        phase(a.lower, m) <= phase(a.upper, m)) {
        return {f.of(a.lower, m), f.of(a.upper, m)};
    }
    return {0.0, b.upper};
}

[[nodiscard]] inline Bounds extension(functions::AtLeast /*f*/, Bounds a, Bounds b) noexcept {
    if (a.upper < b.lower) return nothing;
    return {std::max(a.lower, b.lower), a.upper};
}

} // namespace bounds

} // namespace rtamt
