// Kernels from outside the core, as Python passes them: the table of a loaded library, or a
// function that makes a driver (rtamt.engine.user_operators), which stands for any Python class.
//
// A call to Python takes the GIL. What it raises is kept until the failure is reported.
#pragma once

#include "../program/program.hpp"

#include <nanobind/nanobind.h>

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

namespace rtamt::python {

namespace nb = nanobind;

class Calls {
  public:
    // Of each call a tuple: a capsule "rtamt.kernel" or a function that makes a driver, the bounds
    // of the interval in steps (-1: none), seconds in a step, and the indices of the operands.
    explicit Calls(const nb::list& calls);

    // The same for the program; this object must outlive the executor that runs it.
    [[nodiscard]] std::vector<CallSite> sites() const { return sites_; }

    // The exception that a driver raised last, if any; it is forgotten here.
    [[nodiscard]] nb::object take_error();

    // For Python's garbage collector: an operator's function refers to its module, which may refer
    // to the monitor.
    [[nodiscard]] int traverse(visitproc visit, void* arg) const;
    void clear() noexcept;

    // Lets an exception of a driver pass in place of the one that the core threw because of it.
    void rethrow();

  private:
    struct Driven;
    struct Drop {
        void operator()(Driven* driven) const noexcept;
    };
    std::vector<nb::object> capsules_;
    std::vector<std::unique_ptr<Driven, Drop>> driven_;
    std::vector<CallSite> sites_;
};

// Calls `work`; what a Python operator raised when it was made goes before what the core threw.
template <class Work>
auto making(Calls& calls, Work&& work) {
    try {
        return std::forward<Work>(work)();
    } catch (const std::runtime_error&) {
        calls.rethrow();
        throw;
    }
}

[[nodiscard]] inline Program parse(const nb::bytes& bytes, Domain domain = Domain::discrete,
                                   std::vector<CallSite> calls = {}) {
    return Program::parse({static_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, domain,
                          std::move(calls));
}

} // namespace rtamt::python
