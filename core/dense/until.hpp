// Until over the segments that meet the last w ticks, [s - w, s], oldest to newest:
// max(psi_0, min(phi_0, max(psi_1, min(phi_1, ...)))).
//
// A segment is the map x -> max(psi, min(phi, x)); such maps are closed under composition (ClampOf
// in algebra.hpp), so this is a sliding window over a monoid that does not commute (sliding.hpp).
//
// Cost: amortised O(1) an event whatever w. Memory: 8 bytes and two values a segment inside the
// window.
#pragma once

#include "sliding.hpp"

namespace rtamt::dense {

template <ValueDomain D>
using Until = Sliding<UntilSteps<D>, D>;

} // namespace rtamt::dense
