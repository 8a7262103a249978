#include "dense_monitor.hpp"

#include "../program/snapshot.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

namespace rtamt::early {

namespace {

// How many calls come between two looks at what is not needed any more.
constexpr std::int64_t pause = 64;

[[nodiscard]] std::vector<Bounds> of_every(std::vector<Bounds> ranges, std::size_t inputs) {
    ranges.resize(inputs, bounds::anything);
    return ranges;
}

} // namespace

DenseMonitor::DenseMonitor(Graph graph, DenseSettings settings)
    : engine_(std::move(graph), settings.ranges, true), outputs_(std::move(settings.outputs)),
      decides_(settings.decides),
      samples_(of_every(std::move(settings.ranges), engine_.inputs()), settings.lateness),
      decisions_(outputs_.size()), decided_(outputs_.size()), changes_(outputs_.size()),
      open_(outputs_.size()), held_(outputs_.size()), next_held_(outputs_.size()),
      wanted_(engine_.size()) {
    for (const std::uint32_t output : outputs_) {
        if (output / 2 >= engine_.size()) throw std::invalid_argument("There is no such output.");
    }
    if (!settings.origin.empty()) {
        origin_.emplace(std::move(settings.origin), engine_, settings.causes.has_value());
        engine_.find_beyond(origin_->read_forever());
    }
    if (settings.causes) {
        causes_.emplace(std::move(*settings.causes), engine_, origin_.value(), true);
    } else { // causes are of every value, needed or not
        std::vector<Tick> last(engine_.size(), -1);
        for (const std::uint32_t output : outputs_)
            last[output / 2] = forever;
        if (origin_) origin_->limit(last);
        engine_.limit(last);
    }
    for (std::size_t i = 0; i < outputs_.size() && decides_; ++i)
        decisions_[i].begin(engine_, outputs_[i]);
}

// ---- samples ------------------------------------------------------------------------------------

std::optional<DenseMonitor::Failure> DenseMonitor::take(Tick time, std::span<const Given> given) {
    const auto before = samples_.newest();
    for (const Given& each : given)
        samples_.add(each.input, time, each.bounds);
    return learn(time, before);
}

std::optional<DenseMonitor::Failure> DenseMonitor::watermark(Tick time) {
    const auto newest = samples_.newest();
    samples_.close(time);
    return learn(time, newest);
}

std::optional<DenseMonitor::Failure> DenseMonitor::finish() {
    const auto newest = samples_.newest();
    samples_.finish();
    const auto failure = learn(newest.value_or(0), newest);
    finished_ = !failure;
    return failure;
}

// What has come is reported with the time `at`; `before`: the newest sample before it.
std::optional<DenseMonitor::Failure> DenseMonitor::learn(Tick at, std::optional<Tick> before) {
    samples_.collect(observations_);
    const bool begins = samples_.start() && !begun_;
    std::optional<Failure> failure;
    if (begins) failure = engine_.wrong_constant();
    if (!failure) {
        engine_.settle_inputs(samples_.settled());
        const Tick newest = samples_.start() ? *samples_.newest() - start() : -1;
        failure = engine_.learn(observations_, newest, samples_.ended());
    }
    if (failure) {
        failure->tick += start();
        samples_.rollback();
        return failure;
    }
    samples_.commit();
    begun_ = begun_ || begins;
    if (!begun_) return std::nullopt;
    for (std::size_t i = 0; i < outputs_.size(); ++i)
        collect(i, at, begins ? -1 : *before - start(), begins);
    if (origin_) origin_->read(engine_);
    if (causes_) causes_->read(engine_, *origin_, observations_);
    if (samples_.ended()) return std::nullopt; // what was kept can still be read
    closed_ = std::ranges::min(samples_.settled());
    if (++calls_ % pause == 0) settle();
    return std::nullopt;
}

// ---- results ------------------------------------------------------------------------------------

void DenseMonitor::collect(std::size_t output, Tick at, Tick before, bool begins) {
    const std::uint32_t ref = outputs_[output];
    const Tick newest = *samples_.newest() - start();
    if (!decides_) {
        changes_[output].collect(engine_, ref, before, newest);
        return;
    }
    auto& decided = decided_[output];
    decided.clear();
    if (begins) decisions_[output].date(at);
    decisions_[output].collect(engine_, ref, newest, at, decided);
    std::ranges::sort(decided, {}, &Decision::l);
    std::size_t count = 0; // what continues the run before it is one with it
    for (Decision decision : decided) {
        decision.l += start();
        decision.r += start();
        Decision* last = count > 0 ? &decided[count - 1] : nullptr;
        if (last != nullptr && last->r + 1 == decision.l && last->at == decision.at &&
            last->satisfied == decision.satisfied) {
            last->r = decision.r;
        } else {
            decided[count++] = decision;
        }
    }
    decided.resize(count);
}

std::vector<Change> DenseMonitor::timed(std::vector<Change> runs) const {
    for (Change& change : runs) {
        change.l = plus(change.l, start());
        change.r = plus(change.r, start());
    }
    return runs;
}

std::vector<Change> DenseMonitor::changes(std::size_t output) const {
    return timed(changes_[output].runs(engine_, outputs_[output]));
}

std::vector<Change> DenseMonitor::runs(std::size_t output) const {
    if (!begun_) return {};
    Changes all;
    all.add(*held(output) - start(), *samples_.newest() - start());
    return timed(all.runs(engine_, outputs_[output]));
}

std::optional<Bounds> DenseMonitor::at_start() const {
    if (!origin_) return std::nullopt;
    return origin_->value();
}

std::optional<Bounds> DenseMonitor::at(std::size_t output, Tick time) const {
    const auto first = held(output);
    if (!first || time < *first) return std::nullopt;
    return engine_.at(outputs_[output], std::min(time - start(), forever));
}

std::optional<Bounds> DenseMonitor::caused(std::size_t output, std::optional<Tick> time) const {
    const Tick tick = time.value_or(start());
    if (!begun_ || tick < start()) return std::nullopt;
    return causes_.value().at(output, std::min(tick - start(), forever));
}

std::vector<Change> DenseMonitor::caused(std::size_t output) const {
    if (!begun_) return {};
    const Tick last = finished_ ? *samples_.newest() - start() : forever;
    return timed(causes_.value().runs(output, last));
}

std::variant<Bounds, DenseMonitor::Failure> DenseMonitor::suppose(std::optional<std::size_t> output,
                                                                  Tick time,
                                                                  std::span<const Supposed> later) {
    std::vector<Engine::Observation> observations;
    for (std::size_t k = 0; k < later.size(); ++k) {
        const Supposed& each = later[k];
        const bool last = k + 1 == later.size() || later[k + 1].input != each.input;
        const Tick newest = samples_.newest(each.input).value_or(start()) - start();
        const Tick behind = std::max(newest, samples_.settled()[each.input]);
        const Tick l = std::max(plus(each.from, -start()), plus(behind, 1));
        const Tick r = last ? forever : plus(later[k + 1].from, -start() - 1);
        if (l <= r && l < forever) observations.push_back({each.input, l, r, each.bounds});
    }
    if (auto failure = engine_.suppose(observations)) {
        failure->tick += start();
        return *failure;
    }
    Bounds value{};
    if (output) {
        value = engine_.at(outputs_[*output], std::min(time - start(), forever));
    } else {
        Origin origin = origin_.value();
        origin.read(engine_);
        value = origin.value();
    }
    engine_.revert();
    return value;
}

// The first tick of the trace that may still change, or might before its end.
Tick DenseMonitor::first_open(std::size_t output) const noexcept {
    const Tick horizon = std::max<Tick>(0, engine_.horizon(outputs_[output]));
    return std::max<Tick>(0, plus(closed_ + 1, -horizon));
}

std::optional<Tick> DenseMonitor::held(std::size_t output) const noexcept {
    if (!begun_) return std::nullopt;
    return start() + held_[output];
}

std::optional<Tick> DenseMonitor::complete() const noexcept {
    if (!begun_) return std::nullopt;
    return start() + closed_;
}

// ---- what is not needed any more ----------------------------------------------------------------

void DenseMonitor::settle() {
    std::ranges::fill(wanted_, forever);
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
        Tick from = 0;
        if (decides_) {
            open_[i] = Decisions::open(engine_, outputs_[i], open_[i]);
            from = std::max(first_open(i), open_[i]);
        } else {
            held_[i] = std::min(next_held_[i], changes_[i].first());
            next_held_[i] = first_open(i);
            from = held_[i];
        }
        wanted_[outputs_[i] / 2] = std::min(wanted_[outputs_[i] / 2], from);
    }
    if (origin_) origin_->settle(engine_, closed_, wanted_);
    if (causes_) causes_->settle(engine_, closed_, wanted_);
    engine_.settle(closed_, wanted_);
}

std::size_t DenseMonitor::bytes() const noexcept {
    std::size_t sum = engine_.bytes() + samples_.bytes();
    for (const auto& decisions : decisions_)
        sum += decisions.bytes();
    return sum;
}

void DenseMonitor::transfer(Snapshot& snapshot) {
    engine_.transfer(snapshot);
    if (origin_) origin_->transfer(snapshot);
    if (causes_) causes_->transfer(snapshot);
    for (auto& decisions : decisions_)
        decisions.transfer(snapshot);
    samples_.transfer(snapshot);
    for (auto* ticks : {&open_, &held_, &next_held_}) {
        snapshot.values(ticks->data(), ticks->size());
        for (const Tick tick : *ticks)
            snapshot.require(tick >= 0);
    }
    snapshot.item(closed_);
    snapshot.require(closed_ >= -1 && closed_ < forever);
    snapshot.item(begun_);
    snapshot.item(finished_);
    snapshot.require(begun_ == samples_.start().has_value());
}

} // namespace rtamt::early
