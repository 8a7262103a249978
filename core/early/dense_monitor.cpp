#include "dense_monitor.hpp"

#include "state_checks.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

namespace rtamt::early {

namespace {

// The number of calls between two clean-ups of what is no longer needed.
constexpr std::int64_t pause = 64;

[[nodiscard]] std::vector<Bounds> of_every(std::vector<Bounds> ranges, std::size_t inputs) {
    ranges.resize(inputs, bounds::anything);
    return ranges;
}

} // namespace

DenseMonitor::DenseMonitor(Graph graph, DenseSettings settings)
    : engine_(std::move(graph), settings.ranges, BoundsEngine::Arrival::pieces),
      samples_(of_every(std::move(settings.ranges), engine_.inputs()), settings.lateness,
               settings.waits),
      wanted_(engine_.size()) {
    engine_.keep_undo(settings.several);
    for (const std::uint32_t output : settings.outputs) {
        if (output / 2 >= engine_.size()) throw std::invalid_argument("There is no such output.");
    }
    if (!settings.at_start.empty() || settings.causes) {
        at_start_.emplace(std::move(settings.at_start), engine_, settings.outputs,
                          settings.causes ? BoundsAtStart::Use::as_given
                                          : BoundsAtStart::Use::late);
        engine_.find_beyond(at_start_->read_forever());
    }
    if (settings.causes) {
        causes_.emplace(std::move(*settings.causes), engine_, at_start_.value(), true);
    } else { // causes are of every value, needed or not
        std::vector<Tick> last(engine_.size(), -1);
        for (const std::uint32_t output : settings.outputs)
            last[output / 2] = forever;
        if (at_start_) at_start_->limit(last);
        engine_.limit(last);
    }
    for (const std::uint32_t output : settings.outputs)
        outputs_.emplace_back(output, settings.decides, engine_);
    postpones_ = samples_.late() && !settings.decides && !causes_ && !settings.several &&
                 !engine_.may_fail();
}

// ---- samples ------------------------------------------------------------------------------------

void DenseMonitor::stage(Tick time, std::span<const Given> given, std::optional<Tick> newest) {
    at_ = time;
    before_ = samples_.newest();
    for (const Given& each : given)
        samples_.add(each.input, time, each.bounds);
    if (newest) samples_.reach(*newest);
}

void DenseMonitor::stage_watermark(Tick time) {
    catch_up();
    at_ = time;
    before_ = samples_.newest();
    samples_.close(time);
}

void DenseMonitor::stage_finish() {
    catch_up();
    before_ = samples_.newest();
    at_ = before_.value_or(0);
    samples_.finish();
}

std::optional<DenseMonitor::Failure> DenseMonitor::take(Tick time, std::span<const Given> given) {
    if (postpones_ && begun_ && !given.empty()) {
        postpone(time, given);
        return std::nullopt;
    }
    catch_up();
    stage(time, given, std::nullopt);
    return learn();
}

std::optional<DenseMonitor::Failure> DenseMonitor::watermark(Tick time) {
    stage_watermark(time);
    return learn();
}

std::optional<DenseMonitor::Failure> DenseMonitor::finish() {
    stage_finish();
    return learn();
}

std::optional<DenseMonitor::Failure> DenseMonitor::learn() {
    auto failure = attempt();
    if (!failure) accept();
    return failure;
}

std::optional<DenseMonitor::Failure> DenseMonitor::attempt() {
    samples_.collect(observations_);
    begins_ = samples_.start() && !begun_;
    std::optional<Failure> failure;
    if (begins_) {
        failure = engine_.wrong_constant();
    } else if (!begun_) {
        failure = rehearsal_.attempt(samples_, engine_);
    }
    if (!failure) {
        engine_.settle_inputs(std::ranges::min(samples_.settled()));
        const Tick seen = samples_.start() ? newest() : -1;
        failure = engine_.learn(observations_, seen, samples_.ended());
    }
    if (failure) {
        failure->tick += start();
        samples_.rollback();
    }
    return failure;
}

void DenseMonitor::reject() {
    engine_.revert();
    rehearsal_.reject();
    samples_.rollback();
}

void DenseMonitor::accept() {
    samples_.commit();
    begun_ = begun_ || begins_;
    finished_ = samples_.ended();
    if (!begun_) {
        rehearsal_.accept();
        return;
    }
    if (begins_) rehearsal_.clear();
    report();
    if (at_start_) at_start_->read(engine_);
    if (causes_) causes_->read(engine_, *at_start_, observations_);
    if (finished_) return; // what was kept can still be read
    closed_ = std::ranges::min(samples_.settled());
    if (++calls_ % pause == 0) settle();
}

// What the last call has changed.
void DenseMonitor::report() {
    for (DenseOutput& output : outputs_)
        output.collect(engine_, start(), at_, begins_ ? -1 : *before_ - start(), newest());
}

// ---- late samples -------------------------------------------------------------------------------

void DenseMonitor::postpone(Tick time, std::span<const Given> given) {
    if (!postponed_.empty()) {
        take_closed();
        samples_.postpone();
        others_ = true;
    }
    postponed_.assign(given.begin(), given.end());
    begins_ = false;
    stage(time, given, std::nullopt);
    closed_ = *samples_.closed() - start();
    if (++calls_ % pause == 0) settle();
}

// Those of earlier calls that no other one can precede.
void DenseMonitor::take_closed() {
    samples_.collect_closed(observations_);
    if (!observations_.empty()) apply();
}

void DenseMonitor::catch_up() {
    if (postponed_.empty()) return;
    if (others_) {
        samples_.rollback();
        samples_.collect(observations_);
        apply();
        samples_.commit();
        stage(at_, postponed_, std::nullopt);
    }
    samples_.collect(observations_);
    apply();
    samples_.commit();
    report();
    postponed_.clear();
    others_ = false;
}

// The engine takes what has been collected, which cannot fail.
void DenseMonitor::apply() {
    engine_.settle_inputs(std::ranges::min(samples_.settled()));
    (void)engine_.learn(observations_, newest());
    if (at_start_) at_start_->read(engine_);
}

// ---- results ------------------------------------------------------------------------------------

std::vector<BoundChange> DenseMonitor::changes(std::size_t output) {
    catch_up();
    return outputs_[output].changes(engine_, start());
}

std::vector<BoundChange> DenseMonitor::runs(std::size_t output) {
    if (!begun_) return {};
    catch_up();
    return outputs_[output].runs(engine_, start(), newest());
}

std::optional<Bounds> DenseMonitor::at_start() {
    if (!at_start_ || at_start_->size() == 0) return std::nullopt;
    catch_up();
    return at_start_->value();
}

std::optional<Bounds> DenseMonitor::at(std::size_t output, Tick time) {
    if (!begun_) return std::nullopt;
    catch_up();
    return outputs_[output].at(engine_, time - start());
}

std::optional<Bounds> DenseMonitor::caused(std::size_t output, std::optional<Tick> time) const {
    const Tick tick = time.value_or(start());
    if (!begun_ || tick < start()) return std::nullopt;
    return causes_.value().at(output, std::min(tick - start(), forever));
}

std::vector<BoundChange> DenseMonitor::caused(std::size_t output) const {
    return caused_up_to(output, finished_ ? newest() : forever);
}

std::vector<BoundChange> DenseMonitor::caused_up_to(std::size_t output, Tick last) const {
    if (!begun_) return {};
    return timed(causes_.value().runs(output, last), start());
}

std::variant<Bounds, DenseMonitor::Failure> DenseMonitor::suppose(std::optional<std::size_t> output,
                                                                  Tick time,
                                                                  std::span<const Supposed> later) {
    catch_up();
    std::vector<BoundsEngine::Observation> observations;
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
        value = engine_.at(ref(*output), std::min(time - start(), forever));
    } else {
        BoundsAtStart at_start = at_start_.value();
        at_start.read(engine_);
        value = at_start.value();
    }
    engine_.revert();
    return value;
}

std::optional<Tick> DenseMonitor::held(std::size_t output) const noexcept {
    if (!begun_) return std::nullopt;
    return start() + outputs_[output].held();
}

std::optional<Tick> DenseMonitor::complete() const noexcept {
    if (!begun_) return std::nullopt;
    return start() + closed_;
}

// ---- clean-up -----------------------------------------------------------------------------------

void DenseMonitor::settle() {
    const Tick closed = std::ranges::min(samples_.settled());
    std::ranges::fill(wanted_, forever);
    for (DenseOutput& output : outputs_) {
        if (!postponed_.empty()) output.expect(*before_ - start(), newest());
        Tick& wanted = wanted_[output.ref() / 2];
        wanted = std::min(wanted, output.settle(engine_, closed_));
    }
    if (at_start_) at_start_->settle(engine_, closed, wanted_);
    if (causes_) causes_->settle(engine_, closed, wanted_);
    engine_.settle(closed, wanted_);
}

std::size_t DenseMonitor::bytes() const noexcept {
    std::size_t sum = engine_.bytes() + samples_.bytes() + rehearsal_.bytes();
    for (const DenseOutput& output : outputs_)
        sum += output.bytes();
    return sum;
}

void DenseMonitor::transfer(Snapshot& snapshot) {
    catch_up();
    engine_.transfer(snapshot);
    if (at_start_) at_start_->transfer(snapshot);
    if (causes_) causes_->transfer(snapshot);
    for (DenseOutput& output : outputs_)
        output.transfer(snapshot);
    samples_.transfer(snapshot);
    if (snapshot.loading()) rehearsal_.clear(); // it takes the samples again
    checked::tick(snapshot, closed_, -1);
    snapshot.item(begun_);
    snapshot.item(finished_);
    snapshot.require(begun_ == samples_.start().has_value());
    snapshot.require(engine_.seen() == (begun_ ? newest() : -1));
}

} // namespace rtamt::early
