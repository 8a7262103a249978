// The online monitor as Python sees it: names, times and numbers checked, then the executor.
//
// update, update_pairs and step reject wrong input with a short Refused and change nothing; the
// Python caller checks the input again and raises the full message. No message is formatted here.
#pragma once

#include "../discrete/clock.hpp"
#include "../discrete/executor.hpp"
#include "arrays.hpp"
#include "calls.hpp"
#include "failures.hpp"
#include "names.hpp"
#include "numbers.hpp"
#include "numpy.hpp"
#include "row.hpp"
#include "usage_guard.hpp"

#include <nanobind/nanobind.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace rtamt::python {

class Monitor {
  public:
    Monitor(Program program, const std::vector<nb::str>& names, double period, double tolerance,
            bool strict, const nb::object& ignored, const nb::dict& types,
            std::shared_ptr<Calls> calls, Exceptions exceptions);

    // One sample each. Returns what became known of the first output, a float or None; null, with
    // a Python exception set, if the sample is rejected. update takes values by name, Named or
    // InDict.
    template <class Values>
    [[nodiscard]] PyObject* update(PyObject* time, const Values& values) noexcept;
    [[nodiscard]] PyObject* update_pairs(PyObject* time, PyObject* pairs) noexcept;
    [[nodiscard]] PyObject* step(std::span<PyObject* const> values) noexcept;

    // `after`: how many samples the caller has seen; if others came meanwhile, the chunk is
    // rejected.
    [[nodiscard]] std::vector<Result> push(const std::optional<Column>& times,
                                           const std::vector<Column>& columns,
                                           std::optional<std::int64_t> after);
    // Whether a chunk may be pushed as it is: the timestamps continue those so far, one period
    // apart, and no value is NaN. False for data that Python has to look at, or to reject.
    [[nodiscard]] bool accepts(const Column& times, const std::vector<Column>& columns) const;
    // The same of a dict of columns, with timestamps under the name `time` or a period apart.
    // Returns the number of samples so far, and times and values of what became known of each
    // output; None, with nothing changed, for data that Python has to convert or reject.
    [[nodiscard]] nb::object take_columns(const nb::handle& data, const nb::handle& time);

    [[nodiscard]] std::vector<Result> finish();
    void reset();

    // What the garbage collector looks at.
    [[nodiscard]] Calls& calls() const noexcept { return *calls_; }

    // What the samples so far have left behind; for a monitor made like this one.
    [[nodiscard]] nb::bytes state();
    void restore(const nb::bytes& state);

    // None before the first sample.
    [[nodiscard]] std::optional<double> last(std::uint32_t instruction) const;
    // The value of an output that the last sample made known.
    [[nodiscard]] std::optional<double> latest(std::size_t output) const;
    [[nodiscard]] Result recent(std::size_t count) const;

    [[nodiscard]] std::int64_t samples() const;
    [[nodiscard]] std::uint64_t violations() const;
    [[nodiscard]] std::optional<double> last_time() const;
    [[nodiscard]] std::size_t state_bytes() const;

  private:
    std::shared_ptr<Calls> calls_; // what the executor's calls need
    discrete::Executor executor_;
    discrete::Clock clock_;
    Numbers numbers_;
    Names names_;
    NumPy numpy_;
    Exceptions exceptions_;
    UsageGuard usage_;
    std::vector<double> row_;       // the sample that is being taken
    std::unique_ptr<bool[]> given_; // which of its values the call gave
    std::vector<double> previous_;  // the last sample that was taken, if there is one

    void transfer(Snapshot& snapshot);
    [[nodiscard]] Places places() noexcept { return {row_.data(), given_.get(), row_.size()}; }
    [[nodiscard]] bool ready() const noexcept { return usage_.open(executor_.finished()); }
    [[nodiscard]] double time_of(std::int64_t sample,
                                 std::optional<std::span<const double>> times) const;
    void push(std::optional<std::span<const double>> times, std::span<const double* const> columns,
              std::size_t count, std::span<double* const> outputs);
    template <bool timed, bool keeps, class Read>
    [[nodiscard]] PyObject* sample(const Read& read) noexcept;
    template <bool timed, bool keeps, class Read>
    RTAMT_COLD [[nodiscard]] PyObject* sample_carefully(const Read& read) noexcept;
    template <bool timed>
    [[nodiscard]] PyObject* take(double time) noexcept;
};

} // namespace rtamt::python
