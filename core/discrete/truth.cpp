#include "../values/truth.hpp"

#include "executor_impl.hpp"
#include "kernels_impl.hpp"
#include "wiring_impl.hpp"

namespace rtamt::discrete {

template struct Kernels<Truth>;
template class Wiring<Truth>;
template class BasicExecutor<Truth>;

} // namespace rtamt::discrete
