// Samples that may be late, of which bounds are computed as late as possible.
//
// A row changes bounds when no sample of its tick or an earlier one can arrive any more, or when
// somebody reads bounds. Without a reader the engine thus takes all rows in the order of time,
// however they come. A reader of changes gets those of the last sample: all others are taken before
// it. Operations that may have no value are computed at once, as they may be an error.
#include "discrete_monitor.hpp"

#include <algorithm>

namespace rtamt::early {

std::optional<DiscreteMonitor::Failure>
DiscreteMonitor::learn(Tick index, double time, std::span<const Observation> observations) {
    const auto known = late_rows_.value().at(index);
    row_.assign(known.begin(), known.end());
    given_.clear();
    for (const Observation& each : observations) {
        row_[each.input] = each.bounds;
        given_.push_back(each.input);
    }
    const bool later = postpones_ && engine_->is_defined(row_);
    if (later) {
        postponed_.add(index, known);
    } else {
        catch_up();
        engine_->settle_inputs(closed_after(index));
        if (auto failure = engine_->late_row(index, row_, given_)) {
            failure->tick = std::max(failure->tick, std::min(first_, index));
            return failure; // what is wrong before the trace is wrong at its start as well
        }
    }
    first_ = std::min(first_, index);
    if (index < times_.newest() && !late_rows_->contains(index)) {
        times_.insert(index, time, [&](Tick t) { return late_rows_->after(t); });
    }
    late_rows_->set(index, row_);
    advance(index, time, later);
    return std::nullopt;
}

void DiscreteMonitor::take(Tick index, std::span<const Bounds> row, Tick closed) const {
    engine_->settle_inputs(closed);
    (void)engine_->late_row(index, row, every_input_); // which cannot fail
    if (at_start_) at_start_->read(*engine_, std::min(closed, engine_->seen()));
}

// Those that no other one can precede.
void DiscreteMonitor::take_closed() {
    for (; postponed_.front() <= closed_; postponed_.pop())
        take(postponed_.front(), late_rows_->at(postponed_.front()), postponed_.front());
}

void DiscreteMonitor::catch_up() const {
    if (postponed_.empty()) return;
    const Tick last = postponed_.newest();
    for (; !postponed_.empty(); postponed_.pop()) {
        const Tick t = postponed_.front();
        if (t != last) {
            take(t, late_rows_->at(t), closed_);
        } else if (postponed_.joins()) {
            take(t, postponed_.before(), closed_);
        }
    }
    take(last, late_rows_->at(last), closed_);
    unread_ = true;
}

} // namespace rtamt::early
