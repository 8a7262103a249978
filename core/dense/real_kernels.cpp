// The kernels of reals in a separate file: in a larger one the compiler inlines less, and
// windows are a tenth slower.
#include "../values/real.hpp"

#include "kernels_impl.hpp"

namespace rtamt::dense {

template struct Kernels<Real>;

} // namespace rtamt::dense
