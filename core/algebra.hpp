// The two lattices of robustness, so that no kernel is written once for max and again for min.
//
// The comparison is written so that it compiles to one maxsd/minsd: no std::max, whose order of
// operands costs a blend. NaN never gets here (see kernel.hpp).
#pragma once

#include <limits>

namespace rtamt {

inline constexpr double infinity = std::numeric_limits<double>::infinity();

struct Max {
    static constexpr double identity = -infinity;
    [[nodiscard]] static constexpr double join(double a, double b) noexcept {
        return a > b ? a : b;
    }
};

struct Min {
    static constexpr double identity = infinity;
    [[nodiscard]] static constexpr double join(double a, double b) noexcept {
        return a < b ? a : b;
    }
};

// The map x -> max(low, min(high, x)). A step of until (low = psi, high = phi) is such a map, and
// so is any composition of steps; that makes bounded until a sliding window over a monoid.
struct Clamp {
    double low = -infinity;
    double high = infinity;

    // The map "inner first, then this": the outer one is the older one.
    [[nodiscard]] constexpr Clamp after(const Clamp& inner) const noexcept {
        return {at(inner.low), Min::join(high, inner.high)};
    }

    [[nodiscard]] constexpr double at(double x) const noexcept {
        return Max::join(low, Min::join(high, x));
    }
};

} // namespace rtamt
