// The base of the public monitors in Python: the methods that take one sample.
//
// Where the back end is a compiled monitor, it takes the sample without a Python frame in between.
// Python is called for an error message, for samples that are not plain numbers by name, such as
// objects with fields, and for other back ends: the method `_update_carefully` or `_step_carefully`
// receives the arguments as they came, and `_no_value` makes the error for an undefined value.
#pragma once

#include "names.hpp"

#include <nanobind/nanobind.h>

#include <cstddef>
#include <span>

namespace rtamt::python {

template <class Backend>
class Online {
  public:
    [[nodiscard]] const nb::object& backend() const noexcept { return backend_; }
    void connect(nb::object backend) {
        const bool compiled = nb::isinstance<Backend>(backend) && nb::inst_ready(backend);
        native_ = compiled ? nb::inst_ptr<Backend>(backend) : nullptr;
        backend_ = std::move(backend);
    }

    // The compiled monitor, null where Python has to take the sample, and the object that holds it:
    // reading a value may connect another one.
    struct Connected {
        Backend* native;
        nb::object held;
    };
    [[nodiscard]] Connected connected([[maybe_unused]] nb::handle self) const noexcept {
        const nb::ft_object_guard guard(self);
        return {native_, backend_};
    }

    int traverse(visitproc visit, void* arg) const {
        Py_VISIT(backend_.ptr());
        return 0;
    }
    void clear() {
        native_ = nullptr;
        backend_.reset();
    }

  private:
    nb::object backend_;
    Backend* native_ = nullptr;
};

// Adds MonitorBase, DenseMonitorBase and EarlyMonitorBase; their back ends and the exceptions are
// there.
void add_online(nb::module_& module);

} // namespace rtamt::python
