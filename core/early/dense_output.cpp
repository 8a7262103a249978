#include "dense_output.hpp"

#include "state_checks.hpp"

#include <algorithm>

namespace rtamt::early {

std::vector<BoundChange> timed(std::vector<BoundChange> runs, Tick start) {
    for (BoundChange& change : runs) {
        change.l = plus(change.l, start);
        change.r = plus(change.r, start);
        change.bounds = unsigned_zeros(change.bounds);
    }
    return runs;
}

DenseOutput::DenseOutput(std::uint32_t ref, bool decides, const BoundsEngine& engine)
    : ref_(ref), decides_(decides) {
    if (decides_) decisions_.begin(engine, ref_);
}

void DenseOutput::collect(const BoundsEngine& engine, Tick start, Tick at, Tick before,
                          Tick newest) {
    if (!decides_) {
        changes_.collect(engine, ref_, before, newest);
        return;
    }
    decided_.clear();
    if (before < 0) decisions_.date(at);
    decisions_.collect(engine, ref_, newest, at, decided_);
    std::ranges::sort(decided_, {}, &Decision::l);
    std::size_t count = 0; // what continues the run before it is one with it
    for (Decision decision : decided_) {
        decision.l += start;
        decision.r += start;
        Decision* last = count > 0 ? &decided_[count - 1] : nullptr;
        if (last != nullptr && last->r + 1 == decision.l && last->at == decision.at &&
            last->satisfied == decision.satisfied) {
            last->r = decision.r;
        } else {
            decided_[count++] = decision;
        }
    }
    decided_.resize(count);
}

void DenseOutput::expect(Tick before, Tick newest) {
    changes_ = {};
    if (newest > before) changes_.add(before + 1, newest);
}

std::vector<BoundChange> DenseOutput::changes(const BoundsEngine& engine, Tick start) const {
    return timed(changes_.runs(engine, ref_), start);
}

std::vector<BoundChange> DenseOutput::runs(const BoundsEngine& engine, Tick start,
                                           Tick newest) const {
    BoundChanges all;
    all.add(held_, newest);
    return timed(all.runs(engine, ref_), start);
}

std::optional<Bounds> DenseOutput::at(const BoundsEngine& engine, Tick t) const noexcept {
    if (t < held_) return std::nullopt;
    return unsigned_zeros(engine.at(ref_, std::min(t, forever)));
}

Tick DenseOutput::settle(const BoundsEngine& engine, Tick closed) noexcept {
    const Tick horizon = std::max<Tick>(0, engine.horizon(ref_));
    // The first tick that may still change, or might before the end of the trace.
    const Tick first_open = std::max<Tick>(0, plus(closed + 1, -horizon));
    if (decides_) {
        open_ = EagerVerdicts::open(engine, ref_, open_);
        return std::max(first_open, open_);
    }
    held_ = std::min(next_held_, changes_.first());
    next_held_ = first_open;
    return held_;
}

void DenseOutput::transfer(Snapshot& snapshot) {
    decisions_.transfer(snapshot);
    early::transfer(snapshot, decided_, [&](Decision& decision) { // counted from anywhere
        checked::time(snapshot, decision.l);
        checked::time(snapshot, decision.r);
        snapshot.require(decision.l <= decision.r);
    });
    changes_.transfer(snapshot);
    for (Tick* tick : {&open_, &held_, &next_held_})
        checked::tick_or_forever(snapshot, *tick);
}

} // namespace rtamt::early
