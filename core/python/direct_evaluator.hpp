// Evaluates recordings that need no conversion in one call: reads, checks and copies them, and runs
// all programs of a plan.
//
// Whatever is not plainly right is left to Python, and so are undefined values: see recording.hpp.
//
// Cost: beside reading and the programs, a piece of memory for all that Python gets. Memory: that
// of the evaluators; while it runs, a column for each scan and each of its operands.
#pragma once

#include "evaluator.hpp"
#include "numpy.hpp"

#include <nanobind/nanobind.h>

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace rtamt::python {

// Which recordings are evaluated: those with the period of the programs, within a fraction of it,
// and with so many samples. `given`: the period is not inferred from timestamps.
struct Admitted {
    double period;
    bool given;
    double tolerance;
    std::size_t fewest;
    std::size_t most;
};

class DirectEvaluator {
  public:
    // `stages`: of each the Evaluator, the places of its columns, and the scans over its outputs:
    // their kinds and operands. The variables come first, then the scans in order. Only the last
    // stage has no scans, and it has one output.
    DirectEvaluator(std::vector<nb::str> names, nb::str time, const Admitted& admitted,
                    const nb::list& stages, nb::object threads);

    // A tuple of the memory, the number of samples, and whether there are timestamps; None for data
    // that are not evaluated here. The memory has rows of as many doubles as there are samples: the
    // columns, the timestamps if there are any, and the values. It is a bytearray or, where rows
    // are long, a list of arrays.
    [[nodiscard]] nb::object run(const nb::handle& data);

  private:
    struct Scan {
        std::string kind;
        std::vector<std::size_t> operands;
    };
    struct Stage {
        nb::object owner; // of the evaluator
        Evaluator* evaluator;
        std::vector<std::size_t> columns;
        std::vector<Scan> scans;
    };

    std::vector<nb::str> names_;
    nb::str time_;
    Admitted admitted_;
    std::vector<Stage> stages_;
    nb::object threads_;
    NumPy numpy_;

    [[nodiscard]] bool evaluate(std::vector<const double*>& columns, std::size_t count,
                                double* values) const;
};

void add_direct_evaluator(nb::module_& module);

} // namespace rtamt::python
