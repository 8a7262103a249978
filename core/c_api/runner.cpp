#include "runner.hpp"

#include "early_runner.hpp"

#include <algorithm>
#include <utility>

namespace rtamt::c_api {

// ---- discrete time ------------------------------------------------------------------------------

DiscreteRunner::DiscreteRunner(Program program) : executor_(std::move(program)) {
    outputs_.resize(executor_.program().outputs.size());
}

void DiscreteRunner::step(const double* row, std::span<rtamt_value> known) {
    double first = 0.0;
    if (executor_.step(row, first) == discrete::Outcome::failed) {
        throw Undefined{executor_.failure().instruction, executor_.failure().sample};
    }
    for (dense::EventList& list : outputs_)
        list.resize(0);
    last_known(known);
}

void DiscreteRunner::hold(std::span<const double> row, std::size_t count,
                          std::span<rtamt_value> known) {
    if (count == 1) return step(row.data(), known);
    std::vector<std::vector<double>> columns;
    std::vector<const double*> pointers;
    for (const double value : row)
        pointers.push_back(columns.emplace_back(count, value).data());
    std::vector<std::vector<double>> values;
    std::vector<double*> buffers;
    for (std::size_t output = 0; output < outputs_.size(); ++output) {
        values.emplace_back(executor_.known(output, count));
        buffers.push_back(values.back().data());
    }
    if (const auto failure = executor_.push(pointers, count, buffers)) {
        throw Undefined{failure->instruction, failure->sample};
    }
    for (dense::EventList& list : outputs_)
        list.resize(0);
    last_known(known);
}

// What the last sample made known of the first outputs.
void DiscreteRunner::last_known(std::span<rtamt_value> known) const noexcept {
    for (std::size_t output = 0; output < known.size(); ++output) {
        const std::uint32_t instruction = program().outputs[output];
        known[output] = executor_.samples() > program().instructions[instruction].lag
                            ? rtamt_value{*executor_.last(instruction), 1}
                            : rtamt_value{0.0, 0};
    }
}

std::optional<std::int64_t> DiscreteRunner::known_until(std::size_t output) const noexcept {
    const std::int64_t last =
        executor_.samples() - 1 -
        (finished() ? 0 : program().instructions[program().outputs[output]].lag);
    return last < 0 ? std::nullopt : std::optional(last);
}

void DiscreteRunner::finish() {
    const std::size_t outputs = outputs_.size();
    std::vector<dense::EventList> rest(outputs);
    std::vector<double*> buffers;
    buffers.reserve(outputs);
    for (std::size_t output = 0; output < outputs; ++output) {
        const std::size_t count = executor_.remaining(output);
        rest[output].make_room(count);
        rest[output].resize(count);
        buffers.push_back(rest[output].values());
        for (std::size_t i = 0; i < count; ++i) {
            rest[output].times()[i] = executor_.samples() - static_cast<std::int64_t>(count - i);
        }
    }
    if (const auto failure = executor_.finish(buffers)) {
        throw Undefined{failure->instruction, failure->sample};
    }
    outputs_ = std::move(rest);
}

void DiscreteRunner::reset() noexcept {
    executor_.reset();
    for (dense::EventList& list : outputs_)
        list.resize(0);
}

// ---- dense time ---------------------------------------------------------------------------------

DenseRunner::DenseRunner(Program program)
    : executor_(std::move(program)), fresh_(executor_.program().inputs),
      events_(executor_.program().inputs) {
    outputs_.resize(executor_.program().outputs.size());
}

void DenseRunner::discard() noexcept {
    for (dense::EventList& list : fresh_)
        list.resize(0);
}

void DenseRunner::push() {
    for (dense::EventList& list : outputs_)
        list.resize(0);
    for (std::size_t input = 0; input < fresh_.size(); ++input)
        events_[input] = fresh_[input].view();
    const auto failure = executor_.push(events_, outputs_);
    discard();
    if (failure) throw Undefined{failure->instruction, failure->time};
}

std::optional<std::int64_t> DenseRunner::first(std::size_t input) const noexcept {
    if (const auto first = executor_.first_time(input)) return first;
    const dense::Events fresh = fresh_[input].view();
    return fresh.count != 0 ? std::optional(fresh.times[0]) : std::nullopt;
}

std::optional<std::int64_t> DenseRunner::last(std::size_t input) const noexcept {
    const dense::Events fresh = fresh_[input].view();
    if (fresh.count != 0) return fresh.times[fresh.count - 1];
    return executor_.last_time(input);
}

bool DenseRunner::begun() const noexcept {
    for (std::size_t input = 0; input < fresh_.size(); ++input) {
        if (executor_.last_time(input)) return true;
    }
    return false;
}

void DenseRunner::finish() {
    for (dense::EventList& list : outputs_)
        list.resize(0);
    if (const auto failure = executor_.finish(outputs_)) {
        throw Undefined{failure->instruction, failure->time};
    }
}

void DenseRunner::reset() noexcept {
    executor_.reset();
    discard();
    for (dense::EventList& list : outputs_)
        list.resize(0);
}

std::unique_ptr<Runner> make_runner(Program program, const Metadata& metadata) {
    if (!metadata.early.empty()) {
        EarlyGraph graph = EarlyGraph::parse(metadata.early, program.inputs);
        graph.take_constants(program);
        return std::make_unique<EarlyRunner>(std::move(program), metadata.seconds(),
                                             std::move(graph));
    }
    if (program.domain == Domain::dense) return std::make_unique<DenseRunner>(std::move(program));
    return std::make_unique<DiscreteRunner>(std::move(program));
}

} // namespace rtamt::c_api
