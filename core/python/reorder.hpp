// The class Reorder of the extension module: fleet/reorder.hpp for arrays of numpy.
#pragma once

#include <nanobind/nanobind.h>

namespace rtamt::python {

void add_reorder(const nanobind::module_& module);

} // namespace rtamt::python
