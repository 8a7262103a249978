// Monitors of verdicts and bounds before the horizon, as Python sees them, in discrete time.
//
// update takes plain numbers that come in order; whatever else there is, it refuses, and the Python
// caller brings it in the form of take() or learn().
#pragma once

#include "../early/bound_changes.hpp"
#include "../early/bounds_at_start.hpp"
#include "../early/bounds_engine.hpp"
#include "../early/causation.hpp"
#include "../early/eager_verdicts.hpp"
#include "../early/sample_times.hpp"
#include "../early/zone_engine.hpp"
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

struct EarlySettings {
    double period = 0;
    double tolerance = 0;
    bool late = false;                               // samples may come in any order
    early::Tick lateness = 0;                        // by how many samples at most
    bool replays = false;                            // update() takes nothing by itself
    std::optional<ResultClass<3>> verdict;           // of what update() returns; none: bounds
    std::optional<ChangeClass> change;               // of what reported() returns
    early::Tick zone = early::ZoneEngine::crossover; // up to where bounds are computed anew
};

class EarlyMonitor : public EarlyBackend {
  public:
    EarlyMonitor(const early::Graph& graph, std::vector<std::uint32_t> outputs,
                 const std::vector<early::Item>& items, std::vector<Bounds> ranges,
                 const std::vector<nb::str>& names, const nb::object& ignored,
                 const nb::dict& types, EarlySettings settings,
                 const std::optional<EarlyCauses>& causes, Exceptions exceptions);

    // A list of verdicts, or None; null, with a Python exception set, is a refusal.
    [[nodiscard]] PyObject* update(PyObject* time, const Named& values) noexcept override;

    // All inputs at one time, in order; `after`: how many samples the caller knows of.
    [[nodiscard]] nb::object take(double time, const std::vector<double>& lower,
                                  const std::vector<double>& upper, std::int64_t after);
    // Some inputs at one time.
    [[nodiscard]] nb::object
    learn(double time, const std::vector<std::tuple<std::uint32_t, double, double>>& values,
          std::int64_t after);
    // Nothing at or before a time will come.
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
    [[nodiscard]] std::optional<early::Tick> place(double time) const;
    [[nodiscard]] std::pair<double, double> known(std::uint32_t input, early::Tick sample) const;
    [[nodiscard]] double time(early::Tick sample) const;
    [[nodiscard]] early::Tick held(std::size_t output) const;

    [[nodiscard]] nb::bytes state();
    void restore(const nb::bytes& state);

    [[nodiscard]] std::int64_t samples() const { return samples_; }
    [[nodiscard]] early::Tick newest() const { return times_.newest(); }
    [[nodiscard]] double earliest() const { return times_.earliest(); }
    [[nodiscard]] early::Tick closed() const { return closed_; }
    [[nodiscard]] bool finished() const { return finished_; }
    [[nodiscard]] bool computes_zone() const { return zone_.has_value(); }
    [[nodiscard]] std::size_t state_bytes() const;

  private:
    using Failure = early::BoundsEngine::Failure;

    early::BoundsEngine engine_;
    std::optional<early::ZoneEngine> zone_; // in its place where windows are short
    std::vector<std::uint32_t> outputs_;
    std::vector<early::EagerVerdicts> decisions_; // by output
    std::optional<early::BoundsAtStart> at_start_;
    std::optional<early::Causes> causes_;
    std::optional<ResultClass<2>> causation_; // of what update() returns
    early::SampleTimes times_;
    std::vector<Bounds> ranges_;
    EarlySettings settings_;
    Exceptions exceptions_;
    UsageGuard guard_;
    PlainNumbers numbers_;
    Names names_;
    std::vector<std::uint32_t> steps_before_; // by node
    std::vector<double> row_;
    std::vector<bool> given_;
    std::vector<std::vector<early::Decision>> news_; // by output
    std::vector<early::BoundChanges> changes_;       // by output
    std::vector<early::Tick> open_;                  // by output, the first tick without a verdict
    std::vector<early::Tick> kept_; // by output, the first tick whose bounds the end still gives
    std::vector<early::Tick> wanted_;
    std::vector<early::BoundsEngine::Observation> observations_;
    early::Tick closed_ = -1; // nothing up to here will come
    std::int64_t samples_ = 0;
    bool finished_ = false;

    void transfer(Snapshot& snapshot);
    [[nodiscard]] bool in_order(early::Tick index) const noexcept;
    [[nodiscard]] PyObject* fail(const Failure& failure, early::Tick index, double time) noexcept;
    [[nodiscard]] std::optional<Failure> observe(early::Tick index);
    template <class Value>
    [[nodiscard]] std::optional<Failure> row(early::Tick index, const std::vector<Value>& values);
    [[nodiscard]] std::vector<early::BoundChange> runs(std::size_t output) const;
    [[nodiscard]] early::Tick closed_after(early::Tick index) const noexcept;
    [[nodiscard]] early::Tick final_up_to() const noexcept;
    void note(early::Tick before);
    [[nodiscard]] PyObject* advance(early::Tick index, double time);
    [[nodiscard]] early::Tick lag(std::size_t output) const;
    void settle();
    [[nodiscard]] PyObject* new_data(std::size_t output) noexcept;
    [[nodiscard]] PyObject* result() noexcept;
    nb::object checked(PyObject* result);
    void require(std::int64_t after);
};

// Adds the class to the module.
void add_early_monitor(const nb::module_& module, const Exceptions& exceptions);

} // namespace rtamt::python
