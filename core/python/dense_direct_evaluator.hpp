// Evaluates recordings in dense time that need no conversion in one call: reads, checks and copies
// them, and runs all programs of a plan. As direct_evaluator.hpp.
//
// Cost: beside reading and the programs, a piece of memory for all that Python gets. Memory: that
// of an executor for each program.
#pragma once

#include "../dense/executor.hpp"
#include "recording.hpp"
#include "result_class.hpp"

#include <nanobind/nanobind.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace rtamt::python {

class DenseDirectEvaluator {
  public:
    // `rate`: ticks in a second, a whole number below 2^53. `stages`: of each the program, the
    // places of its signals, and the scans over its outputs: their kinds and operands. The
    // variables come first, then the scans in order. Only the last stage has no scans, and it has
    // one output. `extra`: for how many ticks after the end the other stages run. `signal`: the
    // class of the robustness.
    DenseDirectEvaluator(std::vector<nb::str> names, nb::str time, double rate, std::int64_t extra,
                         const nb::list& stages, const nb::object& signal);

    ~DenseDirectEvaluator() {
        for (const Stage& stage : stages_)
            delete stage.spare->load();
    }
    DenseDirectEvaluator(const DenseDirectEvaluator&) = delete;
    DenseDirectEvaluator& operator=(const DenseDirectEvaluator&) = delete;
    DenseDirectEvaluator(DenseDirectEvaluator&&) = delete;
    DenseDirectEvaluator& operator=(DenseDirectEvaluator&&) = delete;

    // A tuple of the ticks and values of each variable in a bytearray, the numbers of their
    // samples, and the signal of the result; None for data that are not evaluated here.
    [[nodiscard]] nb::object run(const nb::handle& data);

  private:
    struct Scan {
        std::string kind;
        std::vector<std::size_t> operands;
    };
    struct Stage {
        Program program;
        std::vector<std::size_t> signals;
        std::vector<Scan> scans;
        std::unique_ptr<std::atomic<dense::Executor*>> spare; // owned; null while a thread uses it
    };

    struct Samples {
        Given times;
        Given values;
    };

    std::vector<nb::str> names_;
    nb::str time_;
    double rate_;
    std::int64_t extra_;
    std::vector<Stage> stages_;
    ResultClass<2> signal_;
    NumPy numpy_;

    [[nodiscard]] std::optional<std::vector<Samples>> samples_in(const nb::handle& data) const;
    [[nodiscard]] bool to_ticks(std::span<const double> seconds, std::int64_t* ticks) const;
    [[nodiscard]] std::optional<dense::EventList> evaluate(std::vector<dense::Events>& signals,
                                                           std::size_t samples);
};

void add_dense_direct_evaluator(const nb::module_& module);

} // namespace rtamt::python
