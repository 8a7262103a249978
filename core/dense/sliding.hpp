// A sliding window over a monoid: the aggregate of the segments that meet the last w ticks,
// [s - w, s].
//
// A segment [p, q) of the operands is in for s in [p, q + w). Segments are held in two stacks: the
// older ones each with the total from there to the youngest of the older ones, the newer ones as
// they are, with the total of all of them.
//
// Cost: amortised O(1) an event whatever w. Memory: 8 bytes and an element a segment inside the
// window.
#pragma once

#include "../values/monoid.hpp"
#include "kernel.hpp"
#include "merge.hpp"
#include "ring.hpp"

namespace rtamt::dense {

template <Monoid M>
struct SlidingState {
    Pair<typename M::Value> operands;        // of the last segment
    std::size_t older = 0;                   // segments in the stack of the older ones
    typename M::Element newer = M::identity; // total of the rest
};

template <Monoid M, ValueDomain D>
class Sliding final : public Temporal<D, SlidingState<M>> {
  public:
    using Value = typename D::Value;
    using Element = typename M::Element;
    using Base = Temporal<D, SlidingState<M>>;
    using Writer = typename Base::Writer;

    Sliding(std::int64_t lag, std::int64_t width) noexcept
        : Base(lag, M::result(M::identity)), width_(width) {}

    std::int64_t run(std::int64_t frontier) override {
        const std::size_t arriving = arrivals();
        const std::size_t due =
            window_.count_while([&](std::size_t i) { return expiry(i) <= frontier; });
        Writer out = this->open(due + 2 * arriving); // what arrives may leave again
        if constexpr (M::binary) {
            merge(Kernel::a<Value>(), Kernel::b<Value>(), this->own().operands,
                  [&](std::int64_t time, const Pair<Value>& now) {
                      arrive(out, time, M::element(now.a, now.b));
                  });
        } else {
            const BasicEvents<Value> a = Kernel::a<Value>();
            for (std::size_t i = 0; i < a.count; ++i)
                arrive(out, a.times[i], M::element(a.values[i]));
        }
        expire(out, frontier);
        this->close(out, frontier);
        return never;
    }

    void checkpoint() noexcept override {
        Base::checkpoint();
        window_.checkpoint();
    }
    void rollback() noexcept override {
        Base::rollback();
        window_.rollback();
    }
    void transfer(Snapshot& snapshot, std::int64_t frontier) override {
        Base::transfer(snapshot, frontier);
        window_.transfer(snapshot);
        snapshot.require(this->own().older <= window_.size());
        snapshot.require(window_.increasing(-never - 1, frontier, &Segment::begin));
        snapshot.require(window_.empty() || expiry(0) > frontier);
    }

    [[nodiscard]] std::size_t pending() const noexcept override { return window_.size(); }
    [[nodiscard]] std::size_t bytes() const noexcept override {
        return Base::bytes() + window_.bytes();
    }

  protected:
    void reset() noexcept override {
        Base::reset();
        window_.clear();
    }

  private:
    struct Segment {
        std::int64_t begin = 0;
        Element total{};
    };
    std::int64_t width_;
    Ring<Segment> window_;

    // When a segment leaves: w after its end, where the next one begins. The last one lasts.
    [[nodiscard]] std::int64_t expiry(std::size_t i) const noexcept {
        return i + 1 < window_.size() ? later(window_[i + 1].begin, width_) : never;
    }

    [[nodiscard]] Value value() const noexcept {
        return this->own().older != 0 ? M::result(window_.front().total, this->own().newer)
                                      : M::result(this->own().newer);
    }

    [[nodiscard]] std::size_t arrivals() const noexcept {
        return Kernel::a<Value>().count + (M::binary ? Kernel::b<Value>().count : 0);
    }

    void arrive(Writer& out, std::int64_t time, Element element) {
        expire(out, time - 1);
        window_.push_back({time, element});
        this->own().newer = M::append(this->own().newer, element);
        while (expiry(0) <= time)
            leave();
        out.put(time, value());
    }

    void expire(Writer& out, std::int64_t frontier) {
        for (std::int64_t time = expiry(0); time <= frontier && time != never; time = expiry(0)) {
            leave();
            out.put(time, value());
        }
    }

    void leave() {
        if (this->own().older == 0) turn_over();
        window_.pop_front();
        --this->own().older;
    }

    // All newer segments become older ones.
    void turn_over() {
        Element tail = M::identity;
        for (std::size_t i = window_.size(); i > 0; --i) {
            Segment& segment = window_.edit(i - 1);
            tail = M::prepend(segment.total, tail);
            segment.total = tail;
        }
        this->own().older = window_.size();
        this->own().newer = M::identity;
    }
};

} // namespace rtamt::dense
