// The operand d ticks ago, or a given value where it had not begun: once[d,d], and the delays that
// line up operands of different lags.
//
// Cost: two copies an event. Memory: the events of the last d ticks.
#pragma once

#include "kernel.hpp"
#include "ring.hpp"

namespace rtamt::dense {

template <ValueDomain D>
class Shift final : public Temporal<D> {
  public:
    using Value = typename D::Value;
    using Base = Temporal<D>;

    Shift(std::int64_t lag, std::int64_t distance, const Value& absent) noexcept
        : Base(lag, absent), distance_(distance) {}

    std::int64_t run(std::int64_t frontier) override {
        const BasicEvents<Value> a = Kernel::a<Value>();
        const std::size_t due =
            waiting_.count_while([&](std::size_t i) { return waiting_[i].time <= frontier; });
        auto out = this->open(due + a.count);
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
        this->close(out, frontier);
        return never;
    }

    void checkpoint() noexcept override {
        Base::checkpoint();
        waiting_.checkpoint();
    }
    void rollback() noexcept override {
        Base::rollback();
        waiting_.rollback();
    }
    void transfer(Snapshot& snapshot, std::int64_t frontier) override {
        Base::transfer(snapshot, frontier);
        waiting_.transfer(snapshot);
        snapshot.require(waiting_.increasing(frontier, later(frontier, distance_), &Event::time));
    }

    [[nodiscard]] std::size_t pending() const noexcept override { return waiting_.size(); }
    [[nodiscard]] std::size_t bytes() const noexcept override {
        return Base::bytes() + waiting_.bytes();
    }

  protected:
    void reset() noexcept override {
        Base::reset();
        waiting_.clear();
    }

  private:
    struct Event {
        std::int64_t time; // when it is due
        Value value;
    };
    std::int64_t distance_;
    Ring<Event> waiting_;
};

} // namespace rtamt::dense
