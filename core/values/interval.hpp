// The domain of bounds of a robustness: [lower, upper] holds the robustness of every trace that
// agrees with what is known of the signals.
//
// Above the predicates every operation takes max and min of the bounds one by one, and `not` swaps
// them; so the lower bounds are the robustness of the formula with each predicate at its worse end
// and the upper bounds with each at its better end (corner theorem: J. Deshmukh et al., "Robust
// online monitoring of signal temporal logic", 2017).
//
// Cost and memory: twice those of a real.
#pragma once

#include "bounds.hpp"
#include "real.hpp"

#include <cmath>

namespace rtamt {

struct Interval {
    using Value = Bounds;
    using Number = Interval;

    static constexpr Bounds bottom{Real::bottom, Real::bottom};
    static constexpr Bounds top{Real::top, Real::top};
    static constexpr bool total = false;

    [[nodiscard]] static constexpr Bounds join(const Bounds& a, const Bounds& b) noexcept {
        return {Real::join(a.lower, b.lower), Real::join(a.upper, b.upper)};
    }
    [[nodiscard]] static constexpr Bounds meet(const Bounds& a, const Bounds& b) noexcept {
        return {Real::meet(a.lower, b.lower), Real::meet(a.upper, b.upper)};
    }
    [[nodiscard]] static constexpr Bounds neg(const Bounds& a) noexcept {
        return {-a.upper, -a.lower};
    }
    [[nodiscard]] static bool undefined(const Bounds& a) noexcept {
        return Real::undefined(a.lower) || Real::undefined(a.upper);
    }
    [[nodiscard]] static constexpr bool anything(const Bounds& a) noexcept {
        return a.lower == Real::bottom && a.upper == Real::top;
    }
    [[nodiscard]] static constexpr Bounds of(double x) noexcept { return {x, x}; }

    // Of numbers that are known, what the function itself makes of them.
    template <class Function>
    [[nodiscard]] static Bounds apply(const Bounds& a) noexcept {
        return exact(a) ? of(Function::of(a.lower)) : bounds::extension(Function{}, a);
    }
    template <class Function>
    [[nodiscard]] static Bounds apply(const Bounds& a, const Bounds& b) noexcept {
        return exact(a) && exact(b) ? of(Function::of(a.lower, b.lower))
                                    : bounds::extension(Function{}, a, b);
    }

  private:
    [[nodiscard]] static constexpr bool exact(const Bounds& a) noexcept {
        return a.lower == a.upper;
    }
};

static_assert(UniformDomain<Interval>);

} // namespace rtamt
