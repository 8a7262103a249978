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
void scan(std::span<const double> a, std::span<double> out) noexcept {
    double extremum = Algebra::identity;
    for (std::size_t t = a.size(); t-- > 0;) {
        extremum = Algebra::join(a[t], extremum);
        out[t] = extremum;
    }
}

// out[t] = max(psi[t], min(phi[t], out[t+1])), -inf after the end: unbounded until.
inline void scan_until(std::span<const double> phi, std::span<const double> psi,
                       std::span<double> out) noexcept {
    double until = Max::identity;
    for (std::size_t t = phi.size(); t-- > 0;) {
        until = Max::join(psi[t], Min::join(phi[t], until));
        out[t] = until;
    }
}

} // namespace rtamt::discrete
