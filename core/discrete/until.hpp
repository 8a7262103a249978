// Until over the last w slots, oldest to newest: max(psi_0, min(phi_0, max(psi_1, min(phi_1,
// ...)))).
//
// A slot is the map x -> max(psi, min(phi, x)); such maps are closed under composition (ClampOf in
// algebra.hpp), so this is a sliding window over a monoid that does not commute, with the oldest
// map outermost, and the two stacks of two_stack.hpp serve it as they serve max.
//
// Cost: about six comparisons a sample whatever w. Memory: two values a slot of the window.
#pragma once

#include "lane_stretch.hpp"
#include "two_stack.hpp"

namespace rtamt::discrete {

template <ValueDomain D>
using Until = Sliding<UntilSteps<D>>;

} // namespace rtamt::discrete
