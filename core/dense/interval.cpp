#include "../values/interval.hpp"

#include "executor_impl.hpp"
#include "kernels_impl.hpp"
#include "wiring_impl.hpp"

namespace rtamt::dense {

template struct Kernels<Interval>;
template class Wiring<Interval>;
template class BasicExecutor<Interval>;

} // namespace rtamt::dense
