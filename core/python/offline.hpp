// The functions of the module that need no monitor: evaluation of whole traces.
#pragma once

#include "failures.hpp"

#include <nanobind/nanobind.h>

namespace rtamt::python {

void add_offline(nanobind::module_& module, const Exceptions& exceptions);

} // namespace rtamt::python
