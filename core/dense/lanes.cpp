#include "../values/lanes.hpp"

#include "executor_impl.hpp"
#include "kernels_impl.hpp"
#include "wiring_impl.hpp"

namespace rtamt::dense {

template struct Kernels<Lanes<8>>;
template class Wiring<Lanes<8>>;
template class BasicExecutor<Lanes<8>>;

} // namespace rtamt::dense
