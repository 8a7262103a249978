// The joins of values in kernels: the two lattices of a value domain, so that max and min share
// each kernel; addition; and the maps of until.
//
// `associative`: whether values may be joined in another grouping with the same result. `partial`:
// whether a result may be undefined, as inf - inf is.
#pragma once

#include "domain.hpp"
#include "functions.hpp"
#include "real.hpp"

namespace rtamt {

template <Lattice D>
struct MaxOf {
    using Domain = D;
    using Value = typename D::Value;
    static constexpr Value identity = D::bottom;
    static constexpr bool associative = true;
    static constexpr bool partial = false;
    [[nodiscard]] static constexpr Value join(const Value& a, const Value& b) noexcept {
        return D::join(a, b);
    }
};

template <Lattice D>
struct MinOf {
    using Domain = D;
    using Value = typename D::Value;
    static constexpr Value identity = D::top;
    static constexpr bool associative = true;
    static constexpr bool partial = false;
    [[nodiscard]] static constexpr Value join(const Value& a, const Value& b) noexcept {
        return D::meet(a, b);
    }
};

// Addition of numbers. An undefined sum stays undefined, but for bounds of which nothing is known:
// with these the sum may be anything.
template <ValueDomain D>
struct SumOf {
    using Domain = D;
    using Value = typename D::Value;
    static constexpr Value identity = D::of(0.0);
    static constexpr bool associative = false;
    static constexpr bool partial = true;
    [[nodiscard]] static Value join(const Value& a, const Value& b) noexcept {
        if constexpr (requires { D::anything(a); }) {
            if (D::undefined(a)) return D::anything(b) ? b : a;
            if (D::undefined(b)) return D::anything(a) ? a : b;
        }
        return D::template apply<functions::Add>(a, b);
    }
};

// The map x -> max(low, min(high, x)). A step of until (low = psi, high = phi) is such a map, and
// so is any composition of steps; that makes bounded until a sliding window over a monoid.
template <Lattice D>
struct ClampOf {
    using Value = typename D::Value;
    Value low = D::bottom;
    Value high = D::top;

    // The map "inner first, then this": the outer one is the older one.
    [[nodiscard]] constexpr ClampOf after(const ClampOf& inner) const noexcept {
        return {at(inner.low), D::meet(high, inner.high)};
    }

    [[nodiscard]] constexpr Value at(const Value& x) const noexcept {
        return D::join(low, D::meet(high, x));
    }
};

using Max = MaxOf<Real>;
using Min = MinOf<Real>;
using Clamp = ClampOf<Real>;

} // namespace rtamt
