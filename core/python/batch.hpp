// The plan of a requirement over many traces, a row of an array each.
#pragma once

#include <nanobind/nanobind.h>

namespace rtamt::python {

void add_batch(nanobind::module_& module);

} // namespace rtamt::python
