// The quick way to read what an online update in dense time made known: a few points, or none.
#pragma once

#include <nanobind/nanobind.h>

namespace rtamt::python {

// Adds the class TickPoints, a base without memory of its own. Classes that derive from it have the
// attributes `_events`, ticks and then values as bytes, and `_scale`, whose `rate` is the number of
// ticks in a unit of time (None: times are no plain numbers), and a method `_many_points()`.
void add_tick_points(const nanobind::module_& module);

} // namespace rtamt::python
