// The online monitor of dense time as Python sees it: names, times and numbers checked, then the
// executor.
//
// What an update makes known is reported as events, followed by a point at the last known instant.
// update rejects input that is wrong or not plain with a short Refused and changes nothing; the
// Python caller then reads the input with all checks and raises the full message.
#pragma once

#include "../dense/executor.hpp"
#include "arrays.hpp"
#include "calls.hpp"
#include "failures.hpp"
#include "names.hpp"
#include "numbers.hpp"
#include "row.hpp"
#include "update_signal.hpp"
#include "usage_guard.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace rtamt::python {

using Times = nb::ndarray<const std::int64_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

// A step function, its times in ticks and its values.
using EventColumn = std::pair<Times, Column>;

// Views of the columns, as many as the inputs; each has as many times as values.
[[nodiscard]] std::vector<dense::Events> events_of(const std::vector<EventColumn>& columns,
                                                   std::size_t inputs);

// Times and values as numpy arrays; the list is empty afterwards.
[[nodiscard]] nb::tuple hand_over(dense::EventList& list);
[[nodiscard]] nb::list hand_over(std::vector<dense::EventList>& lists);

class DenseMonitor {
  public:
    DenseMonitor(Program program, const std::vector<nb::str>& names, const nb::object& ignored,
                 const nb::dict& types, std::shared_ptr<Calls> calls, Exceptions exceptions);

    // The unit of times of update() until the next reset(), in ticks, a whole number below 2^53;
    // `whole`: times are integers. Results are objects of this class of
    // update_signal_class(), of the given scale.
    void set_time_scale(const nb::type_object& signal, const nb::object& scale, double rate,
                        bool whole);

    // Any variables at one instant, by name: Named or InDict. Returns what became known of the
    // first output; null, with a Python exception set, if the sample is rejected.
    template <class Values>
    [[nodiscard]] PyObject* update(PyObject* time, const Values& values) noexcept;

    // What became known of the first output, times and values.
    [[nodiscard]] nb::tuple push(const std::vector<EventColumn>& columns);
    [[nodiscard]] nb::tuple finish();

    // What the last update made known of an output; of the first one, update() and push() have
    // handed it over.
    [[nodiscard]] nb::tuple last_output(std::size_t output) const;

    // The same of every output in one call: a list for each, of pairs of time and value.
    [[nodiscard]] nb::list points() const;

    void reset();

    // What the garbage collector looks at.
    [[nodiscard]] Calls& calls() const noexcept { return *calls_; }

    // What the samples so far have left behind, except the time scale; for a monitor made like
    // this one.
    [[nodiscard]] nb::bytes state();
    void restore(const nb::bytes& state);

    [[nodiscard]] std::vector<std::int64_t> counts() const;
    [[nodiscard]] std::optional<std::int64_t> start() const;
    [[nodiscard]] std::optional<std::int64_t> known(std::size_t output) const;
    [[nodiscard]] std::vector<std::optional<std::int64_t>> last_times() const;
    [[nodiscard]] std::int64_t last_possible() const;
    [[nodiscard]] std::size_t state_bytes() const;

  private:
    std::shared_ptr<Calls> calls_; // what the executor's calls need
    dense::Executor executor_;
    Names names_;
    Numbers numbers_;
    Exceptions exceptions_;
    UsageGuard usage_;
    std::int64_t time_ = 0;                          // of the instant that is being taken
    std::vector<double> row_;                        // its values
    std::unique_ptr<bool[]> given_;                  // for which inputs there is one
    std::vector<dense::Events> events_;              // the same
    std::vector<dense::EventList> results_;          // of the last update, an output each
    std::vector<dense::EventList> spare_;            // of the next one, which may fail
    std::vector<std::optional<std::int64_t>> until_; // up to when each output was reported
    std::vector<std::int64_t> counts_;               // samples of each input
    std::optional<UpdateSignals> signals_;           // makes the results
    nb::object nothing_;                             // the result without events
    bool has_time_scale_ = false;                    // whether the time scale has been set
    double rate_ = 1.0;                              // ticks in 1
    bool whole_ = false;

    void transfer(Snapshot& snapshot);
    [[nodiscard]] Places places() noexcept { return {row_.data(), given_.get(), row_.size()}; }
    void require_output(std::size_t output) const;
    [[nodiscard]] PyObject* fail(const dense::Failure& failure) const noexcept;
    [[nodiscard]] bool ready() const noexcept { return usage_.open(executor_.finished()); }
    template <class Values, class Numbers>
    [[nodiscard]] const char* read_values(const Values& values, const Numbers& numbers,
                                          const Places& places) const noexcept;
    template <class Values>
    [[nodiscard]] bool read(PyObject* time, const Values& values) noexcept;
    [[nodiscard]] bool bind_buffers() noexcept;
    void close();
    [[nodiscard]] PyObject* result() const noexcept;
    [[nodiscard]] nb::tuple take(std::vector<dense::EventList>& results);
};

} // namespace rtamt::python
