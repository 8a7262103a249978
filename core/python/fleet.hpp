// The class Fleet of the extension module: fleet/fleet.hpp for arrays of numpy.
#pragma once

#include <nanobind/nanobind.h>

namespace rtamt::python {

void add_fleet(const nanobind::module_& module);

} // namespace rtamt::python
