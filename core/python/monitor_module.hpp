#pragma once

#include "failures.hpp"

#include <nanobind/nanobind.h>

namespace rtamt::python {

// Adds Monitor and DenseMonitor.
void add_monitors(const nanobind::module_& module, const Exceptions& exceptions);

} // namespace rtamt::python
