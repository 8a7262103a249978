// The class ReorderBuffer of the extension module: fleet/reorder_buffer.hpp for arrays of numpy.
#pragma once

#include <nanobind/nanobind.h>

namespace rtamt::python {

void add_reorder_buffer(const nanobind::module_& module);

} // namespace rtamt::python
