#include "dense_rehearsal.hpp"

#include <algorithm>
#include <limits>
#include <utility>

namespace rtamt::early {

namespace {

// A failure in the caller's ticks; what has no value whatever comes has none from the start on.
[[nodiscard]] BoundsEngine::Failure at_or_after(Tick start, Tick origin,
                                                BoundsEngine::Failure failure) noexcept {
    failure.tick = std::max(start, failure.tick + origin);
    return failure;
}

} // namespace

std::optional<BoundsEngine::Failure> DenseRehearsal::attempt(const Samples& samples,
                                                             const BoundsEngine& like) {
    if (!samples.late() || !like.may_fail()) return std::nullopt;
    const auto start = samples.latest_first();
    if (!start) return std::nullopt;
    if (!taken_ || (like.reads_start() && *start != taken_->start)) {
        return begin(samples, like, *start);
    }
    samples.collect_first(taken_->origin, *start, taken_->start, observations_);
    const auto failure = taken_->engine.learn(observations_, *samples.newest() - taken_->origin);
    if (failure) return at_or_after(*start, taken_->origin, *failure);
    change_ = Change::learned;
    start_before_ = std::exchange(taken_->start, *start);
    return std::nullopt;
}

// Takes all samples. The engine counts from the start; from the first tick that a sample may still
// have if nothing depends on the start, which may then move.
std::optional<BoundsEngine::Failure> DenseRehearsal::begin(const Samples& samples,
                                                           const BoundsEngine& like, Tick start) {
    const Tick origin = like.reads_start() ? start : *samples.closed() + 1;
    const Tick newest = *samples.newest();
    if (newest - origin >= Samples::longest) return std::nullopt; // no trace is as long
    BoundsEngine engine(like.graph(), samples.ranges(), BoundsEngine::Arrival::pieces);
    engine.limit(std::vector<Tick>(engine.size(), -1)); // only what may have no value
    if (const auto failure = engine.wrong_constant()) return at_or_after(start, origin, *failure);
    samples.collect_first(origin, start, std::numeric_limits<Tick>::max(), observations_);
    if (const auto failure = engine.learn(observations_, newest - origin)) {
        return at_or_after(start, origin, *failure);
    }
    change_ = Change::replaced;
    replaced_ = std::exchange(taken_, Taken{std::move(engine), origin, start});
    return std::nullopt;
}

void DenseRehearsal::accept() noexcept {
    change_ = Change::nothing;
    replaced_.reset();
}

void DenseRehearsal::reject() {
    if (change_ == Change::learned) {
        taken_->engine.revert();
        taken_->start = start_before_;
    } else if (change_ == Change::replaced) {
        taken_ = std::move(replaced_);
    }
    accept();
}

void DenseRehearsal::clear() noexcept {
    taken_.reset();
    accept();
}

std::size_t DenseRehearsal::bytes() const noexcept {
    return taken_ ? taken_->engine.bytes() : 0;
}

} // namespace rtamt::early
