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
#include "recording.hpp"
#include "result_class.hpp"

#include <nanobind/nanobind.h>

#include <cstddef>
#include <span>
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

// What the robustness is returned as: the class of signals, those of timestamps one period apart
// and of timestamps in memory, and the period as a fraction.
struct SignalClasses {
    ResultClass<2> signal;
    ResultClass<3> regular_times;
    ResultClass<3> stored_times;
    nb::object period;
};

class DirectEvaluator {
  public:
    // `stages`: of each the Evaluator, the places of its columns, and the scans over its outputs:
    // their kinds and operands. The variables come first, then the scans in order. Only the last
    // stage has no scans, and it has one output.
    DirectEvaluator(std::vector<nb::str> names, nb::str time, const Admitted& admitted,
                    const nb::list& stages, nb::object threads, SignalClasses classes);

    // A tuple of the memory, the number of samples, whether there are timestamps, and the signal;
    // None for data that are not evaluated here. The memory has rows of as many doubles as there
    // are samples: the columns, and the timestamps if there are any. It is a bytearray or, where
    // rows are long, a list of arrays.
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
    SignalClasses classes_;
    NumPy numpy_;

    [[nodiscard]] bool read_times(const Given& given, std::span<double> seconds) const;
    [[nodiscard]] bool evaluate(std::vector<const double*>& columns, std::size_t count,
                                double* values) const;
};

void add_direct_evaluator(nb::module_& module);

} // namespace rtamt::python
