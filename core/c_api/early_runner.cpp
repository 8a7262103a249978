#include "early_runner.hpp"

#include "../early/graph_bytes.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace rtamt::c_api {

namespace {

using early::Tick;

// How many samples come between two looks at what is not needed any more.
constexpr std::int64_t pause = 64;

using early::GraphReader;

[[nodiscard]] std::span<const std::uint8_t> span_of(const std::string& bytes) noexcept {
    return {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
}

} // namespace

EarlyGraph EarlyGraph::parse(const std::string& bytes, std::uint32_t inputs) {
    GraphReader reader(span_of(bytes));
    EarlyGraph parsed;
    parsed.graph.inputs = inputs;
    const std::uint32_t nodes = reader.count(early::node_size);
    const std::uint32_t items = reader.count(early::item_size);
    const std::uint32_t first = reader.number();
    GraphReader::require(nodes > 0 && first > 0 && first < items);
    for (std::uint32_t i = 0; i < nodes; ++i)
        parsed.graph.nodes.push_back(early::read_node(reader));
    parsed.graph.check();
    for (std::uint32_t i = 0; i < items; ++i)
        parsed.truth.push_back(early::read_item(reader, nodes));
    for (std::uint32_t i = 0; i < inputs && reader.left(); ++i) {
        const double lower = reader.real();
        const double upper = reader.real();
        GraphReader::require(lower <= upper);
        parsed.ranges.push_back({lower, upper});
    }
    GraphReader::require(parsed.ranges.empty() || parsed.ranges.size() == inputs);
    reader.end();
    parsed.robustness.assign(parsed.truth.begin(), parsed.truth.begin() + first);
    return parsed;
}

void EarlyGraph::take_constants(const Program& program) {
    std::size_t place = program.inputs;
    for (early::Node& node : graph.nodes) {
        for (early::Step& step : node.steps) {
            GraphReader::require(place < program.instructions.size());
            const Instruction& instruction = program.instructions[place++];
            if (step.opcode != Opcode::constant) continue;
            GraphReader::require(instruction.opcode == Opcode::constant);
            step.x = instruction.x;
        }
    }
    GraphReader::require(place == program.instructions.size());
}

EarlyRunner::EarlyRunner(Program program, double period, EarlyGraph graph)
    : program_(std::move(program)), period_(period), graph_(std::move(graph)),
      engine_(graph_.graph, graph_.ranges, early::BoundsEngine::Arrival::rows),
      robustness_(graph_.robustness, engine_), truth_(graph_.truth, engine_),
      wanted_(engine_.size()), bounds_(robustness_.value()) {
    std::uint32_t before = program_.inputs;
    for (const early::Node& node : graph_.graph.nodes) {
        steps_before_.push_back(before);
        before += static_cast<std::uint32_t>(node.steps.size());
    }
    if (program_.domain != Domain::discrete || program_.outputs.size() != outputs) {
        throw std::invalid_argument("This is not a program that can be run: bounds at the start of "
                                    "the trace are four outputs of discrete time.");
    }
    outputs_.resize(outputs);
    limit();
}

void EarlyRunner::limit() {
    std::vector<Tick> last(engine_.size(), -1);
    robustness_.limit(last);
    truth_.limit(last);
    engine_.limit(last);
}

void EarlyRunner::take(const double* row) {
    const std::span<const double> values(row, program_.inputs);
    if (const auto failure = engine_.row(samples_, values)) {
        throw Undefined{steps_before_[failure->node] + failure->step, samples_};
    }
    robustness_.read(engine_);
    truth_.read(engine_);
    ++samples_;
    bounds_ = robustness_.value();
    decide(truth_.value());
    if (samples_ % pause == 0) settle();
}

void EarlyRunner::decide(const Bounds& truth) noexcept {
    const double verdict = truth.lower > 0 ? infinity : truth.upper < 0 ? -infinity : 0.0;
    if (verdict == verdict_) return;
    verdict_ = verdict;
    decided_ = samples_ - 1;
}

void EarlyRunner::settle() {
    std::ranges::fill(wanted_, early::forever);
    robustness_.settle(engine_, samples_ - 1, wanted_);
    truth_.settle(engine_, samples_ - 1, wanted_);
    engine_.settle(samples_ - 1, wanted_);
}

void EarlyRunner::step(const double* row, std::span<rtamt_value> known) {
    take(row);
    for (dense::EventList& list : outputs_)
        list.resize(0);
    show(known);
}

void EarlyRunner::hold(std::span<const double> row, std::size_t count,
                       std::span<rtamt_value> known) {
    Snapshot before;
    transfer(before);
    try {
        for (std::size_t i = 0; i < count; ++i)
            take(row.data());
    } catch (const Undefined&) {
        Snapshot read(before.bytes());
        transfer(read);
        throw;
    }
    for (dense::EventList& list : outputs_)
        list.resize(0);
    show(known);
}

rtamt_value EarlyRunner::value(std::size_t output) const noexcept {
    if (output < 2) {
        return {.value = output == 0 ? bounds_.lower : bounds_.upper, .known = begun() ? 1 : 0};
    }
    if (verdict_ == 0.0) return {.value = 0.0, .known = 0};
    return {.value = output == 2 ? verdict_ : static_cast<double>(decided_) * period_, .known = 1};
}

void EarlyRunner::show(std::span<rtamt_value> known) const noexcept {
    for (std::size_t output = 0; output < known.size(); ++output)
        known[output] = value(output);
}

std::optional<std::int64_t> EarlyRunner::known_until(std::size_t output) const noexcept {
    return output < outputs && value(output).known != 0 ? std::optional<std::int64_t>(0)
                                                        : std::nullopt;
}

void EarlyRunner::finish() {
    finished_ = true;
    for (dense::EventList& list : outputs_)
        list.resize(0);
    if (!begun()) return;
    bounds_ = robustness_.ended(engine_, samples_);
    decide(truth_.ended(engine_, samples_));
    for (std::size_t output = 0; output < outputs; ++output) {
        const rtamt_value last = value(output);
        if (last.known != 0) outputs_[output].append(0, last.value);
    }
}

void EarlyRunner::reset() {
    early::BoundsEngine engine(graph_.graph, graph_.ranges, early::BoundsEngine::Arrival::rows);
    robustness_ = early::BoundsAtStart(graph_.robustness, engine);
    truth_ = early::BoundsAtStart(graph_.truth, engine);
    engine_ = std::move(engine);
    limit();
    bounds_ = robustness_.value();
    samples_ = 0;
    decided_ = -1;
    verdict_ = 0.0;
    finished_ = false;
    for (dense::EventList& list : outputs_)
        list.resize(0);
}

void EarlyRunner::transfer(Snapshot& snapshot) {
    if (!snapshot.loading() && begun()) settle();
    engine_.transfer(snapshot);
    robustness_.transfer(snapshot);
    truth_.transfer(snapshot);
    snapshot.item(bounds_);
    snapshot.item(samples_);
    snapshot.item(decided_);
    snapshot.item(verdict_);
    snapshot.item(finished_);
    snapshot.require(samples_ >= 0 && samples_ < longest && decided_ < samples_ && decided_ >= -1);
    snapshot.require(engine_.seen() == samples_ - 1);
    snapshot.require(bounds_.lower == bounds_.lower && bounds_.upper == bounds_.upper &&
                     verdict_ == verdict_);
}

} // namespace rtamt::c_api
