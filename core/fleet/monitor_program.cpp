#include "monitor_program.hpp"

#include "../early/graph_bytes.hpp"
#include "../program/crc32.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace rtamt::fleet {

namespace {

using early::GraphReader;
using early::Tick;

constexpr std::size_t checksum_size = 4;
constexpr std::int64_t most_ticks = 9'007'199'254'740'992; // in a second: 2^53

[[noreturn]] void refuse(const std::string& reason) {
    throw std::invalid_argument("This is not a program that can be run: " + reason + ".");
}

[[nodiscard]] std::vector<std::uint32_t> read_numbers(GraphReader& reader) {
    std::vector<std::uint32_t> numbers(reader.count(4));
    for (std::uint32_t& number : numbers)
        number = reader.number();
    return numbers;
}

// A text for people, which C passes on without its length.
[[nodiscard]] std::string read_text(GraphReader& reader) {
    std::string text = reader.text();
    GraphReader::require(text.find('\0') == std::string::npos);
    return text;
}

[[nodiscard]] MonitorProgram::Input read_input(GraphReader& reader) {
    MonitorProgram::Input input;
    input.name = read_text(reader);
    const std::uint32_t boolean = reader.number();
    GraphReader::require(boolean <= 1);
    input.boolean = boolean == 1;
    input.range.lower = reader.real();
    input.range.upper = reader.real();
    GraphReader::require(input.range.lower <= input.range.upper);
    return input;
}

[[nodiscard]] early::CauseGraph read_causes(GraphReader& reader) {
    early::CauseGraph causes;
    causes.parts.resize(reader.count(44));
    for (early::Cause& part : causes.parts)
        part = early::read_cause(reader);
    causes.outputs = read_numbers(reader);
    causes.starts.resize(reader.count(16));
    for (early::StartingCause& start : causes.starts)
        start = early::read_start(reader);
    return causes;
}

[[nodiscard]] early::DenseRequirements::Group read_group(GraphReader& reader,
                                                         const MonitorProgram& program) {
    early::DenseRequirements::Group group;
    group.inputs = read_numbers(reader);
    for (const std::uint32_t input : group.inputs) {
        GraphReader::require(input < program.inputs.size());
        group.settings.ranges.push_back(program.inputs[input].range);
    }
    group.graph.inputs = static_cast<std::uint32_t>(group.inputs.size());
    group.graph.nodes.resize(reader.count(early::node_size));
    for (early::Node& node : group.graph.nodes)
        node = early::read_node(reader);
    group.graph.check();
    group.settings.outputs = read_numbers(reader);
    group.settings.at_start.resize(reader.count(early::item_size));
    for (early::Item& item : group.settings.at_start)
        item = early::read_item(reader, group.graph.nodes.size());
    const std::uint32_t caused = reader.number();
    GraphReader::require(caused == (program.mode == MonitorProgram::Mode::causation ? 1U : 0U));
    if (caused != 0) group.settings.causes = read_causes(reader);
    group.settings.lateness = program.lateness;
    group.settings.decides = program.mode == MonitorProgram::Mode::eager;
    const bool starts = program.mode == MonitorProgram::Mode::interval || caused != 0;
    GraphReader::require(!starts || !group.settings.at_start.empty());
    for (const std::uint32_t output : group.settings.outputs)
        GraphReader::require(output / 2 < group.graph.nodes.size());
    return group;
}

} // namespace

bool MonitorProgram::begins(std::span<const std::uint8_t> bytes) noexcept {
    return bytes.size() >= magic.size() &&
           std::equal(magic.begin(), magic.end(), bytes.begin(),
                      [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; });
}

MonitorProgram MonitorProgram::parse(std::span<const std::uint8_t> bytes) {
    constexpr std::size_t head = magic.size() + 2 * sizeof(std::uint32_t);
    if (!begins(bytes) || bytes.size() < head + checksum_size) refuse("it ends too early");
    const auto body = bytes.first(bytes.size() - checksum_size);
    GraphReader reader(body.subspan(magic.size()));
    const std::uint32_t kind = reader.number();
    if (const std::uint32_t found = kind & 0xFFFFU; found != format) {
        refuse("its format has version " + std::to_string(found) + ", and this is for version " +
               std::to_string(format));
    }
    if (GraphReader(bytes.last(checksum_size)).number() != crc32(body)) {
        refuse("its checksum does not match, so it was damaged on the way");
    }
    MonitorProgram program;
    const std::uint32_t mode = kind >> 16U & 0xFFU;
    const std::uint32_t domain = kind >> 24U;
    GraphReader::require(mode <= 3 && domain <= 1 && (mode != 0 || domain == 1));
    program.mode = static_cast<Mode>(mode);
    program.domain = domain == 1 ? Domain::dense : Domain::discrete;
    program.version = reader.number();
    program.numerator = reader.tick();
    program.denominator = reader.tick();
    GraphReader::require(program.numerator > 0 && program.denominator > 0);
    program.tolerance = reader.real();
    GraphReader::require(program.tolerance >= 0 && std::isfinite(program.tolerance));
    const Tick lateness = reader.tick();
    GraphReader::require(lateness >= -1 && lateness < early::forever);
    if (lateness >= 0) program.lateness = lateness;
    const std::uint32_t inputs = reader.count(24);
    for (std::uint32_t i = 0; i < inputs; ++i)
        program.inputs.push_back(read_input(reader));
    program.formula = read_text(reader);
    program.made_of = read_text(reader);
    const std::uint32_t meanings = reader.count(8);
    for (std::uint32_t i = 0; i < meanings; ++i) {
        const std::uint32_t step = reader.number();
        program.meanings[step] = read_text(reader);
    }
    if (const std::string code = reader.text(); program.mode == Mode::delayed) {
        program.program = Program::parse(
            {reinterpret_cast<const std::uint8_t*>(code.data()), code.size()}, program.domain);
        GraphReader::require(program.program->inputs == inputs &&
                             !program.program->outputs.empty());
    } else {
        GraphReader::require(code.empty());
    }
    const std::uint32_t groups = reader.count(16);
    for (std::uint32_t i = 0; i < groups; ++i)
        program.groups.push_back(read_group(reader, program));
    const std::uint32_t outputs = reader.count(4);
    for (std::uint32_t i = 0; i < outputs; ++i) {
        auto& places = program.outputs.emplace_back();
        const std::uint32_t count = reader.count(8);
        for (std::uint32_t k = 0; k < count; ++k) {
            const std::uint32_t group = reader.number();
            const std::uint32_t output = reader.number();
            GraphReader::require(group < groups &&
                                 output < program.groups[group].settings.outputs.size());
            places.push_back({group, output});
        }
        GraphReader::require(count > 0);
    }
    reader.end();
    const bool early = program.mode != Mode::delayed;
    GraphReader::require((groups > 0) == early && outputs <= 1 &&
                         (program.domain == Domain::dense || groups == 1));
    if (program.mode == Mode::eager) GraphReader::require(outputs == 1);
    if (program.domain == Domain::discrete) { // its rows have all inputs in order
        std::vector<std::uint32_t> all(inputs);
        std::iota(all.begin(), all.end(), 0U);
        GraphReader::require(program.groups.front().inputs == all);
    } else {
        GraphReader::require(program.numerator == 1 && program.denominator < most_ticks);
        std::vector<bool> read(inputs); // a sample of each goes to a group
        for (const auto& group : program.groups) {
            for (const std::uint32_t input : group.inputs)
                read[input] = true;
        }
        GraphReader::require(!early || std::ranges::all_of(read, std::identity{}));
    }
    std::uint32_t before = 0;
    for (const early::DenseRequirements::Group& group : program.groups) {
        auto& own = program.steps_before.emplace_back();
        for (const early::Node& node : group.graph.nodes) {
            own.push_back(before);
            before += static_cast<std::uint32_t>(node.steps.size());
        }
    }
    return program;
}

Tick MonitorProgram::lag(std::size_t output) const {
    Tick lag = 0;
    for (const auto& [group, place] : outputs.at(output)) {
        const early::DenseRequirements::Group& own = groups[group];
        lag = std::max(lag, own.graph.nodes[own.settings.outputs[place] / 2].horizon);
    }
    return lag;
}

std::string MonitorProgram::meaning(std::uint32_t step) const {
    const auto found = meanings.find(step);
    return found != meanings.end() ? "'" + found->second + "'"
                                   : "instruction " + std::to_string(step);
}

} // namespace rtamt::fleet
