// Monitors of verdicts and bounds before the horizon, as Python sees them, in discrete time.
//
// update takes plain numbers in order; it rejects anything else, and the Python
// caller brings it in the form of take() or learn().
#pragma once

#include "../early/discrete_monitor.hpp"
#include "change_class.hpp"
#include "early_backend.hpp"
#include "failures.hpp"
#include "names.hpp"
#include "numbers.hpp"
#include "usage_guard.hpp"

#include <nanobind/nanobind.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

namespace rtamt::python {

class EarlyMonitor : public EarlyBackend {
  public:
    struct Settings {
        bool replays = false;                    // update() takes nothing by itself
        std::optional<ResultClass<3>> verdict;   // of what update() returns; none: bounds
        std::optional<ResultClass<2>> causation; // likewise
        std::optional<ChangeClass> change;       // of what reported() returns
    };
    EarlyMonitor(const early::Graph& graph, early::DiscreteSettings monitor,
                 const std::vector<nb::str>& names, const nb::object& ignored,
                 const nb::dict& types, Settings settings, Exceptions exceptions);

    // A list of verdicts, or None; null, with a Python exception set, is a refusal.
    [[nodiscard]] PyObject* update(PyObject* time, const Named& values) noexcept override;

    // All inputs at one time, in order; `after`: how many samples the caller knows of.
    [[nodiscard]] nb::object take(double time, const std::vector<double>& lower,
                                  const std::vector<double>& upper, std::int64_t after);
    // Some inputs at one time.
    [[nodiscard]] nb::object
    learn(double time, const std::vector<std::tuple<std::uint32_t, double, double>>& values,
          std::int64_t after);
    // No sample at or before a time will arrive.
    [[nodiscard]] nb::object watermark(double time);
    [[nodiscard]] nb::object finish();

    // The verdicts of an output that the last call decided.
    [[nodiscard]] nb::object verdicts(std::size_t output);
    [[nodiscard]] std::optional<std::pair<double, double>> at_start() const;
    [[nodiscard]] std::optional<std::pair<double, double>> bounds(std::size_t output,
                                                                  early::Tick sample) const;
    // Runs (first, last, lower, upper) of an output that the last call changed.
    [[nodiscard]] std::vector<std::tuple<early::Tick, early::Tick, double, double>>
    changes(std::size_t output) const;
    // The same as a list of objects with times; of samples that come in order.
    [[nodiscard]] nb::object reported(std::size_t output) const;
    // The bounds of an output at a sample, or of the formula at the start, if later samples had
    // these bounds of all inputs: (first, last, lower, upper), counted from the sample after the
    // newest.
    [[nodiscard]] nb::object supposed(
        std::optional<std::size_t> output, early::Tick sample,
        const std::vector<
            std::tuple<early::Tick, early::Tick, std::vector<double>, std::vector<double>>>& later);
    // Violation and satisfaction that the newest sample causes.
    [[nodiscard]] std::pair<double, double> causation_at_start() const;
    [[nodiscard]] std::pair<double, double> causation(std::size_t output, early::Tick sample) const;
    // Runs (first, last, violation, satisfaction); the last one may never end.
    [[nodiscard]] std::vector<std::tuple<early::Tick, early::Tick, double, double>>
    caused(std::size_t output) const;
    bool begin_at(early::Tick sample);
    [[nodiscard]] std::optional<early::Tick> place(double time) const;
    [[nodiscard]] std::pair<double, double> known(std::uint32_t input, early::Tick sample) const;
    [[nodiscard]] double time(early::Tick sample) const;
    [[nodiscard]] early::Tick held(std::size_t output) const;

    [[nodiscard]] nb::bytes state();
    void restore(const nb::bytes& state);

    [[nodiscard]] std::int64_t samples() const { return monitor_.samples(); }
    [[nodiscard]] early::Tick newest() const { return monitor_.newest(); }
    [[nodiscard]] double earliest() const { return monitor_.earliest(); }
    [[nodiscard]] early::Tick closed() const { return monitor_.closed(); }
    [[nodiscard]] bool finished() const { return monitor_.finished(); }
    [[nodiscard]] bool computes_zone() const { return monitor_.computes_zone(); }
    [[nodiscard]] std::size_t state_bytes() const { return monitor_.bytes(); }

  private:
    using Failure = early::DiscreteMonitor::Failure;

    early::DiscreteMonitor monitor_;
    Settings settings_;
    Exceptions exceptions_;
    UsageGuard guard_;
    PlainNumbers numbers_;
    Names names_;
    std::vector<std::uint32_t> steps_before_; // by node
    std::vector<double> row_;
    std::vector<early::DiscreteMonitor::Observation> observations_;

    [[nodiscard]] PyObject* fail(const Failure& failure, early::Tick index, double time) noexcept;
    void require_output(std::size_t output) const;
    // `now`: the time of the newest sample as it is reported, if there is such an object.
    [[nodiscard]] PyObject* decided(std::size_t output, PyObject* now = nullptr) const noexcept;
    [[nodiscard]] PyObject* result(PyObject* now = nullptr) const noexcept;
    nb::object checked(PyObject* result) const;
    void require(std::int64_t after);
};

// Adds the class to the module.
void add_early_monitor(const nb::module_& module, const Exceptions& exceptions);

} // namespace rtamt::python
