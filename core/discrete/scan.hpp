// Unbounded future over a whole trace: one pass from its end, offline only.
//
// Cost: one or two comparisons a sample. No memory.
#pragma once

#include "../values/algebra.hpp"

#include <cstddef>
#include <span>

namespace rtamt::discrete {

// out[t] = extremum of a[t], a[t+1], ...: unbounded eventually (Max) and always (Min).
template <class Algebra>
void scan(std::span<const typename Algebra::Value> a,
          std::span<typename Algebra::Value> out) noexcept {
    auto extremum = Algebra::identity;
    for (std::size_t t = a.size(); t-- > 0;) {
        extremum = Algebra::join(a[t], extremum);
        out[t] = extremum;
    }
}

// out[t] = max(psi[t], min(phi[t], out[t+1])), bottom after the end: unbounded until.
template <ValueDomain D>
void scan_until(std::span<const typename D::Value> phi, std::span<const typename D::Value> psi,
                std::span<typename D::Value> out) noexcept {
    auto until = D::bottom;
    for (std::size_t t = phi.size(); t-- > 0;) {
        until = D::join(psi[t], D::meet(phi[t], until));
        out[t] = until;
    }
}

} // namespace rtamt::discrete
