// Many traces of one length: a plan over several of them at once.
//
// Robustness is computed for eight traces at a time, a lane each (values/lanes.hpp), the few that
// are left one by one. Where all values are truth values, predicates are evaluated trace by trace
// and packed, and everything above them joins words of 64 traces (values/truth.hpp). A trace gets
// the same bits as alone.
//
// Cost: a fraction of a microsecond for a short trace. Memory: the executors; during a call, a few
// columns of eight numbers a sample, or of a word a sample.
#pragma once

#include "../program/stages.hpp"
#include "../program/truth_plan.hpp"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace rtamt::discrete {

// The traces of a batch: numbers of rows, each with `count` samples; rows lie `width` apart.
struct BatchRows {
    std::span<const double* const> columns;
    std::span<const std::int64_t> rows;
    std::size_t width;
    std::size_t count;
    double* results;

    [[nodiscard]] const double* samples(std::size_t column, std::size_t trace) const noexcept {
        return columns[column] + offset(trace);
    }
    [[nodiscard]] double* result(std::size_t trace) const noexcept {
        return results + offset(trace);
    }

  private:
    [[nodiscard]] std::size_t offset(std::size_t trace) const noexcept {
        return static_cast<std::size_t>(rows[trace]) * width;
    }
};

class Batch {
  public:
    // Programs without calls, whose state belongs to one run.
    Batch(std::vector<Stage> stages, std::size_t variables);
    ~Batch();
    Batch(const Batch&) = delete;
    Batch& operator=(const Batch&) = delete;
    Batch(Batch&&) = delete;
    Batch& operator=(Batch&&) = delete;

    // Writes the values of each trace; returns whether all are defined. Threads may call it at the
    // same time.
    [[nodiscard]] bool evaluate(const BatchRows& rows);

    [[nodiscard]] std::size_t variables() const noexcept { return variables_; }

    // Whether words of 64 traces are joined.
    [[nodiscard]] bool joins_words() const noexcept { return truth_.has_value(); }

  private:
    class Worker;

    std::vector<Stage> stages_;
    std::size_t variables_;
    std::optional<TruthPlan> truth_;
    std::atomic<Worker*> spare_{nullptr}; // owned; null while a thread uses it
};

} // namespace rtamt::discrete
