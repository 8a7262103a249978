// A monitor as a co-simulation unit, whatever the version of FMI: variables by value reference,
// communication steps, state. What is wrong is thrown as std::invalid_argument or c_api::Undefined,
// and everything is then as it was.
//
// Value references: the inputs from 0 on, then robustness, verdict, known, known_since of all
// requirements together, where there are several these four of each, then the parameters. A program
// of bounds has lower, upper, verdict, decided_since instead. src/rtamt/fmi/variables.py counts in
// the same way. An input or parameter is a number here, which a declared type lets simulators read
// and set as a Boolean or an integer.
//
// Discrete time: sample k is what the inputs are at start + k periods, and a step from t to t + h
// takes the samples in [t, t + h), with the inputs held. Dense time: every communication point
// from which a step is made is a sample of every input. No output depends on an input directly.
#pragma once

#include "../c_api/monitor.hpp"
#include "../program/snapshot.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace rtamt::fmi {

class Component {
  public:
    static constexpr std::uint32_t fields = 4; // variables of each requirement

    // `folder` is where program.rtamt lies; the token must be that of the program.
    Component(const std::string& folder, const std::string& token);

    // The life of a unit, in this order; what comes at another time is refused. `begin`, which may
    // be left out: when the simulation starts. `settle`: parameters are fixed, steps may come.
    void begin(double time);
    void initialise();
    void settle();
    void terminate();
    void reset();

    // From the communication point `time` to `time + length`.
    void advance(double time, double length);
    [[nodiscard]] double reached() const noexcept { return now_.reached; }

    [[nodiscard]] double real(std::uint32_t reference) const;
    [[nodiscard]] std::int64_t integer(std::uint32_t reference) const;
    [[nodiscard]] std::int32_t integer32(std::uint32_t reference) const;
    [[nodiscard]] bool boolean(std::uint32_t reference) const;
    // Of inputs and parameters, whatever their types: Booleans are 1 or 0, members are their codes.
    // All of them, or none if one is refused.
    void set(std::span<const std::uint32_t> references, std::span<const double> values);

    [[nodiscard]] std::vector<std::uint8_t> save();
    void restore(std::span<const std::uint8_t> state);

    // The sentence for a value that does not exist.
    [[nodiscard]] std::string undefined(const c_api::Undefined& failure) const {
        return monitor_->undefined(failure);
    }

  private:
    // The numbers are those of saved states.
    enum class Phase : std::uint8_t {
        created = 0,
        stepping = 1,
        terminated = 2,
        initialising = 3,
    };

    // What is known of one requirement, or of all together.
    struct Outcome {
        double robustness = 0.0; // of bounds the lower one
        double upper = 0.0;      // of bounds alone
        double verdict = 0.0;    // +inf or -inf; 0 as long as it is not known
        double since = 0.0;
        bool known = false;
    };

    // All that is not in the monitor.
    struct Now {
        Phase phase = Phase::created;
        double start = 0.0;
        double reached = 0.0;
        std::vector<Outcome> outcomes; // the first is of all together
        std::vector<double> inputs;

        void transfer(Snapshot& snapshot);
    };

    std::vector<std::uint8_t> program_;
    std::unique_ptr<c_api::Monitor> monitor_;
    Now now_;

    [[nodiscard]] double step() const noexcept { return monitor_->metadata().seconds(); }
    [[nodiscard]] Now fresh() const;
    [[nodiscard]] std::uint32_t outputs() const noexcept { // the first reference of one
        return static_cast<std::uint32_t>(now_.inputs.size());
    }
    [[nodiscard]] std::uint32_t parameters() const noexcept { // the first reference of one
        return outputs() + static_cast<std::uint32_t>(now_.outcomes.size()) * fields;
    }
    // Whether an input or a parameter has this reference.
    [[nodiscard]] bool is_settable(std::uint32_t reference) const noexcept {
        const std::size_t count = monitor_->metadata().parameters.size();
        return reference < outputs() ||
               (reference >= parameters() && reference - parameters() < count);
    }
    [[nodiscard]] bool is_output(std::uint32_t reference) const noexcept {
        return reference >= outputs() && reference < parameters();
    }
    [[nodiscard]] const Outcome& outcome(std::uint32_t reference) const noexcept {
        return now_.outcomes[(reference - outputs()) / fields];
    }
    void require(Phase phase, const char* call, const char* when) const;
    void check_set(std::uint32_t reference, double value) const;
    void advance_discrete(double time, double end);
    void report_bounds(std::span<const rtamt_value> known) noexcept;
    [[nodiscard]] bool is_early() const noexcept { return !monitor_->metadata().early.empty(); }
    void advance_dense(double time);
    [[nodiscard]] std::int64_t instant(double time) const;
    [[nodiscard]] std::optional<std::int64_t> tick_of(double time) const noexcept;
    [[nodiscard]] double seconds_of(std::int64_t tick) const noexcept;
};

// The value of fmi2ResourceLocation, a file URI, as a path.
[[nodiscard]] std::string path_of(const std::string& uri);

} // namespace rtamt::fmi
