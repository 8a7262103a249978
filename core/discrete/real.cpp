#include "../values/real.hpp"

#include "executor_impl.hpp"
#include "wiring_impl.hpp"

namespace rtamt::discrete {

template class Wiring<Real>;
template class BasicExecutor<Real>;

} // namespace rtamt::discrete
