// The two lattices of a value domain, so that no kernel is written once for max and again for min,
// and the maps that until is made of.
#pragma once

#include "domain.hpp"
#include "real.hpp"

namespace rtamt {

template <ValueDomain D>
struct MaxOf {
    using Domain = D;
    using Value = typename D::Value;
    static constexpr Value identity = D::bottom;
    [[nodiscard]] static constexpr Value join(const Value& a, const Value& b) noexcept {
        return D::join(a, b);
    }
};

template <ValueDomain D>
struct MinOf {
    using Domain = D;
    using Value = typename D::Value;
    static constexpr Value identity = D::top;
    [[nodiscard]] static constexpr Value join(const Value& a, const Value& b) noexcept {
        return D::meet(a, b);
    }
};

// The map x -> max(low, min(high, x)). A step of until (low = psi, high = phi) is such a map, and
// so is any composition of steps; that makes bounded until a sliding window over a monoid.
template <ValueDomain D>
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
