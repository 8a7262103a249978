// What an update in dense time returns: a signal whose points lie in the object itself, so that
// making and reading it costs one piece of memory and no look-up of attributes.
#pragma once

#include "../dense/events.hpp"

#include <nanobind/nanobind.h>

#include <cstdint>

namespace rtamt::python {

namespace nb = nanobind;

// Makes the signals of one time scale.
class UpdateSignals {
  public:
    // `type`: what update_signal_class() returned. `scale`: the format of times, whose `rate` is
    // the number of ticks in a unit of time (None: times are no quotients of doubles).
    UpdateSignals(const nb::type_object& type, const nb::object& scale);

    // Null, with a Python exception set, where memory runs out.
    [[nodiscard]] PyObject* make(const dense::Events& events) const noexcept;

  private:
    nb::object type_;
    nb::object scale_;
    std::int64_t rate_;
};

// Adds update_signal_class(base): a class that derives from a Python class whose instances have
// nothing but slots. It has the attributes `_events`, ticks and then values as bytes, and `_scale`,
// and the method points(), which calls `_many_points()` of the base where times are no quotients of
// doubles.
void add_update_signal(nb::module_& module);

} // namespace rtamt::python
