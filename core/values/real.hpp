// The domain of one robustness: a double.
//
// The comparisons are written so that each compiles to one maxsd or minsd: no std::max, whose order
// of operands costs a blend.
#pragma once

#include "domain.hpp"

#include <cmath>
#include <limits>

namespace rtamt {

inline constexpr double infinity = std::numeric_limits<double>::infinity();

struct Real {
    using Value = double;
    using Number = Real;

    static constexpr double bottom = -infinity;
    static constexpr double top = infinity;
    static constexpr bool total = true;

    [[nodiscard]] static constexpr double join(double a, double b) noexcept {
        return a > b ? a : b;
    }
    [[nodiscard]] static constexpr double meet(double a, double b) noexcept {
        return a < b ? a : b;
    }
    [[nodiscard]] static constexpr double neg(double a) noexcept { return -a; }
    [[nodiscard]] static bool undefined(double a) noexcept { return std::isnan(a); }
    [[nodiscard]] static constexpr double of(double x) noexcept { return x; }

    template <class Function, class... Doubles>
    [[nodiscard]] static double apply(Doubles... operands) noexcept {
        return Function::of(operands...);
    }
};

static_assert(UniformDomain<Real>);

} // namespace rtamt
