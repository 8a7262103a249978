// The program of a fleet with a monitor for each key: dense time, and the verdict modes for which
// there are no records. Fleet.compile() writes it (src/rtamt/fleet/monitor_program.py);
// docs/reference/program.md describes its bytes.
#pragma once

#include "../early/dense_requirements.hpp"
#include "../program/program.hpp"

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rtamt::fleet {

struct MonitorProgram {
    static constexpr std::string_view magic = "RTAMTMON";
    static constexpr std::uint16_t format = 1;

    enum class Mode : std::uint8_t { delayed, eager, interval, causation };

    struct Input {
        std::string name;
        bool boolean = false;
        Bounds range{};
    };

    Mode mode = Mode::delayed;
    Domain domain = Domain::dense;
    std::uint32_t version = 0;  // of the states of its monitors, see Snapshot
    std::int64_t numerator = 1; // seconds of a step: the sampling period, or the tick
    std::int64_t denominator = 1;
    double tolerance = 0; // of a gap, in periods
    std::optional<early::Tick> lateness;
    std::vector<Input> inputs;
    std::string formula;
    std::string made_of;                           // what a state depends on
    std::map<std::uint32_t, std::string> meanings; // of instructions, or of steps of all graphs

    // Delayed verdicts run a program, all others graphs.
    std::optional<Program> program;
    std::vector<early::DenseRequirements::Group> groups;
    std::vector<std::vector<early::DenseRequirements::Place>> outputs;
    std::vector<std::vector<std::uint32_t>> steps_before; // by group and node

    // Whether bytes begin like such a program.
    [[nodiscard]] static bool begins(std::span<const std::uint8_t> bytes) noexcept;

    // Throws std::invalid_argument with one sentence.
    [[nodiscard]] static MonitorProgram parse(std::span<const std::uint8_t> bytes);

    [[nodiscard]] double period() const noexcept {
        return static_cast<double>(numerator) / static_cast<double>(denominator);
    }
    // How many steps after an instant an output is final at the latest.
    [[nodiscard]] early::Tick lag(std::size_t output) const;
    // What a step of a graph computes.
    [[nodiscard]] std::string meaning(std::uint32_t step) const;
};

} // namespace rtamt::fleet
