// Monitors of verdicts and bounds before the horizon, as Python sees them, in dense time.
//
// All times are ticks, and runs reach up to and without their ends; but for those of update(),
// which takes plain numbers and refuses whatever else there is: the Python caller brings it to
// learn().
#pragma once

#include "../early/dense_requirements.hpp"
#include "early_backend.hpp"
#include "failures.hpp"
#include "names.hpp"
#include "usage_guard.hpp"

#include <nanobind/nanobind.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

namespace rtamt::python {

class DenseEarlyMonitor : public EarlyBackend {
  public:
    using Tick = early::Tick;

    struct Settings {
        std::vector<Bounds> ranges;
        bool late;                               // samples may arrive in any order
        bool decides;                            // verdicts; if not, bounds
        bool replays;                            // update() takes nothing by itself
        std::optional<ResultClass<2>> causation; // of what update() returns
    };
    // Of each node of all groups of `monitor`, `steps_before` are how many steps come before its
    // own.
    DenseEarlyMonitor(early::DenseRequirements monitor,
                      std::vector<std::vector<std::uint32_t>> steps_before, Settings settings,
                      const std::vector<nb::str>& names, const nb::object& ignored,
                      const nb::dict& types, Exceptions exceptions);

    // update() takes numbers of which 1 is so many ticks, and returns objects of this class.
    void set_time_scale(const nb::object& verdict, double rate);

    // A list of verdicts, or None; null, with a Python exception set, is a refusal.
    [[nodiscard]] PyObject* update(PyObject* time, const Named& values) noexcept override;

    // Samples (input, lower, upper) at one tick; `after`: how many the caller knows of.
    void learn(Tick tick, const std::vector<std::tuple<std::uint32_t, double, double>>& values,
               std::int64_t after);
    void watermark(Tick tick);
    void finish();

    // (begin, end, satisfied, decided at) and (begin, end, lower, upper)
    [[nodiscard]] std::vector<std::tuple<Tick, Tick, bool, Tick>>
    verdicts(std::size_t output) const;
    using Runs = std::vector<std::tuple<Tick, Tick, double, double>>;
    [[nodiscard]] Runs changes(std::size_t output);
    [[nodiscard]] Runs runs(std::size_t output);

    [[nodiscard]] std::optional<std::pair<double, double>> at_start();
    [[nodiscard]] std::optional<std::pair<double, double>> bounds(std::size_t output, Tick tick);
    // Of an output, or none for the start; suppositions (input, from, lower, upper) in order.
    [[nodiscard]] std::optional<std::pair<double, double>>
    supposed(std::optional<std::size_t> output, Tick tick,
             const std::vector<std::tuple<std::uint32_t, Tick, double, double>>& later);
    // Violation and satisfaction that the last call caused: at the start, at a tick, and as runs.
    [[nodiscard]] std::pair<double, double> causation_at_start();
    [[nodiscard]] std::optional<std::pair<double, double>>
    causation(std::size_t output, std::optional<Tick> tick) const;
    [[nodiscard]] Runs caused(std::size_t output) const;
    [[nodiscard]] std::pair<double, double> known(std::uint32_t input, Tick tick) const;
    [[nodiscard]] std::optional<Tick> held(std::size_t output) const;

    [[nodiscard]] nb::bytes state();
    void restore(const nb::bytes& state);

    [[nodiscard]] std::int64_t samples() const;
    [[nodiscard]] const std::vector<std::int64_t>& counts() const { return counts_; }
    [[nodiscard]] std::vector<Tick> last_times() const;
    [[nodiscard]] Tick newest() const;
    [[nodiscard]] Tick closed() const;
    [[nodiscard]] Tick complete() const;
    [[nodiscard]] bool finished() const { return monitor_.finished(); }
    [[nodiscard]] std::size_t state_bytes() const { return monitor_.bytes(); }

  private:
    using Failure = early::DenseRequirements::Failure;

    early::DenseRequirements monitor_;
    Settings settings_;
    Exceptions exceptions_;
    UsageGuard guard_;
    Names names_;
    std::vector<std::vector<std::uint32_t>> steps_before_; // by group and node
    std::vector<std::int64_t> counts_;                     // samples of each input
    std::vector<early::DenseMonitor::Given> given_;
    std::optional<ResultClass<4>> verdict_; // of what update() returns
    double rate_ = 0;

    [[nodiscard]] bool takes(PyObject* time, const Named& values, Tick& tick) noexcept;
    [[nodiscard]] PyObject* fail(const Failure& failure) const noexcept;
    void check(const std::optional<Failure>& failure) const;
    [[nodiscard]] PyObject* new_data() const noexcept;
    void require_output(std::size_t output) const;
    void transfer(Snapshot& snapshot);
};

// Adds the class to the module.
void add_dense_early_monitor(const nb::module_& module, const Exceptions& exceptions);

} // namespace rtamt::python
