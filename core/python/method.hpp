// Methods of the Python monitors that cost no Python call while all is well.
//
// A Method stands in a class for a function. Called on an object whose `_backend` is a compiled
// monitor, it hands the arguments over as they lie on Python's stack; where that monitor refuses
// them, has no value for them, or is none, it calls the function, which knows every case and writes
// the sentence. An update that failed has changed nothing, so it can be tried again.
#pragma once

#include <nanobind/nanobind.h>

namespace rtamt::python {

namespace nb = nanobind;

// Adds the type to the module, in which it finds the compiled monitors and what they raise.
void add_method_type(const nb::module_& module);

} // namespace rtamt::python
