// A program that evaluates many whole traces: it is parsed once, and what runs it is kept.
//
// A long trace is evaluated in parts, on several cores (discrete/parts.hpp).
//
// Cost: for a short trace, a fraction of a microsecond beside its samples. Memory: that of an
// executor.
#pragma once

#include "../discrete/executor.hpp"
#include "failures.hpp"
#include "numpy.hpp"

#include <nanobind/nanobind.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace rtamt::python {

class Evaluator {
  public:
    // The program has no calls, whose state belongs to one run.
    Evaluator(const nb::bytes& program, Exceptions exceptions);
    ~Evaluator() { delete spare_.load(); }
    Evaluator(const Evaluator&) = delete;
    Evaluator& operator=(const Evaluator&) = delete;
    Evaluator(Evaluator&&) = delete;
    Evaluator& operator=(Evaluator&&) = delete;

    // `columns`: contiguous arrays of doubles, one an input and all of `count` samples. Returns a
    // list of as many values of each output. A long trace is evaluated by as many threads as
    // `allowed()` returns.
    [[nodiscard]] nb::list run(const nb::list& columns, std::size_t count,
                               const nb::object& allowed);

    // The same of columns and outputs of `count` doubles each, by so many threads at most; needs no
    // GIL.
    [[nodiscard]] std::optional<discrete::Failure> evaluate(std::span<const double* const> columns,
                                                            std::size_t count,
                                                            std::span<double* const> outputs,
                                                            std::size_t threads);

    // How many threads evaluate so many samples: for many as many as `allowed()` returns.
    [[nodiscard]] std::size_t threads(std::size_t count, const nb::object& allowed) const;

    [[nodiscard]] std::size_t outputs() const noexcept { return program_.outputs.size(); }
    [[nodiscard]] const Program& program() const noexcept { return program_; }

  private:
    using Executor = discrete::Executor;

    Program program_;
    Exceptions exceptions_;
    NumPy numpy_;
    std::atomic<Executor*> spare_{nullptr}; // owned; null while a thread uses it

    [[nodiscard]] std::vector<Buffer> columns_of(const nb::list& columns, std::size_t count) const;
};

void add_evaluator(const nb::module_& module, const Exceptions& exceptions);

} // namespace rtamt::python
