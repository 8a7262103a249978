// The operand d ticks ago, or a given value where it had not begun: once[d,d], and the delays that
// line up operands of different lags.
//
// Cost: two copies an event. Memory: the events of the last d ticks.
#pragma once

#include "kernel.hpp"
#include "ring.hpp"

namespace rtamt::dense {

class Shift final : public Temporal {
  public:
    Shift(std::int64_t lag, std::int64_t distance, double absent) noexcept
        : Temporal(lag, absent), distance_(distance) {}

    std::int64_t run(std::int64_t frontier) override {
        const Events a = this->a();
        const std::size_t due =
            waiting_.count_while([&](std::size_t i) { return waiting_[i].time <= frontier; });
        Writer out = open(due + a.count);
        for (std::size_t i = 0; i < due; ++i) {
            out.put(waiting_.front().time, waiting_.front().value);
            waiting_.pop_front();
        }
        for (std::size_t i = 0; i < a.count; ++i) {
            const std::int64_t time = later(a.times[i], distance_);
            if (time <= frontier) {
                out.put(time, a.values[i]);
            } else if (time != never) {
                waiting_.push_back({time, a.values[i]});
            }
        }
        close(out, frontier);
        return never;
    }

    void checkpoint() noexcept override {
        Temporal::checkpoint();
        waiting_.checkpoint();
    }
    void rollback() noexcept override {
        Temporal::rollback();
        waiting_.rollback();
    }
    void transfer(Snapshot& snapshot, std::int64_t frontier) override {
        Temporal::transfer(snapshot, frontier);
        waiting_.transfer(snapshot);
        snapshot.require(waiting_.increasing(frontier, later(frontier, distance_), &Event::time));
    }

    [[nodiscard]] std::size_t pending() const noexcept override { return waiting_.size(); }
    [[nodiscard]] std::size_t bytes() const noexcept override {
        return Temporal::bytes() + waiting_.bytes();
    }

  protected:
    void reset() noexcept override {
        Temporal::reset();
        waiting_.clear();
    }

  private:
    struct Event {
        std::int64_t time; // when it is due
        double value;
    };
    std::int64_t distance_;
    Ring<Event> waiting_;
};

} // namespace rtamt::dense
