// The online monitor of dense time as Python sees it: names, times and numbers checked, then the
// executor.
//
// update refuses what is wrong with a short Refused and changes nothing; the Python caller looks
// again and writes the sentence.
#pragma once

#include "../dense/executor.hpp"
#include "arrays.hpp"
#include "monitor.hpp"
#include "names.hpp"
#include "numbers.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstddef>
#include <cstdint>
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

[[noreturn]] void raise_undefined(const Exceptions& exceptions, const dense::Failure& failure);

class DenseMonitor {
  public:
    DenseMonitor(Program program, const std::vector<nb::str>& names, const nb::object& ignored,
                 Exceptions exceptions);

    // Any variables at one instant. Two lists, the times and the values that became known of the
    // first output, or None where it has no new event; null, with a Python exception set, is a
    // refusal.
    [[nodiscard]] PyObject* update(PyObject* time, PyObject* values) noexcept;

    [[nodiscard]] nb::list push(const std::vector<EventColumn>& columns);
    [[nodiscard]] nb::list finish();
    void reset();

    [[nodiscard]] std::optional<std::int64_t> start() const;
    [[nodiscard]] std::optional<std::int64_t> known(std::size_t output) const;
    [[nodiscard]] std::vector<std::optional<std::int64_t>> last_times() const;
    [[nodiscard]] std::int64_t last_possible() const noexcept { return executor_.last_possible(); }
    [[nodiscard]] std::size_t state_bytes() const;

  private:
    dense::Executor executor_;
    Names names_;
    Numbers numbers_;
    Exceptions exceptions_;
    std::int64_t time_ = 0;             // of the instant that is being read
    std::vector<double> row_;           // its values
    std::vector<dense::Events> events_; // one for each input that has a value then
    std::vector<dense::EventList> results_;
    bool busy_ = false; // another thread is inside, or a number's own __float__ came back

    void require_idle() const;
    PyObject* refuse(const char* reason) const noexcept;
    [[nodiscard]] PyObject* fail(const dense::Failure& failure) const noexcept;
    [[nodiscard]] bool ready() const noexcept;
    [[nodiscard]] bool read_time(PyObject* time) noexcept;
    [[nodiscard]] const char* read_values(PyObject* values) noexcept;
    [[nodiscard]] PyObject* known_events() const noexcept;

    template <class Work>
    void exclusively(std::size_t count, Work&& work);
};

} // namespace rtamt::python
