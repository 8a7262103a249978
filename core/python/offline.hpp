// The functions of the module that need no monitor: evaluation of whole traces.
#pragma once

#include "../dense/events.hpp"
#include "failures.hpp"

#include <nanobind/nanobind.h>

#include <span>
#include <string_view>

namespace rtamt::python {

// Unbounded future over whole columns of the same length: run_max and run_min of one, until of two.
void scan(std::string_view kind, std::span<const std::span<const double>> operands,
          std::span<double> out);

// The same over whole step functions.
[[nodiscard]] dense::EventList dense_scan(std::string_view kind,
                                          std::span<const dense::Events> operands);

void add_offline(nanobind::module_& module, const Exceptions& exceptions);

} // namespace rtamt::python
