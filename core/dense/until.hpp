// Until over the segments that meet the last w ticks, [s - w, s], oldest to newest:
// max(psi_0, min(phi_0, max(psi_1, min(phi_1, ...)))).
//
// A segment [p, q) of the two operands merged is in for s in [p, q + w), and is the map
// x -> max(psi, min(phi, x)); such maps are closed under composition (Clamp in algebra.hpp). So
// this is a sliding window over a monoid, held in two stacks: the older segments each with the
// composition from there to the youngest of the older ones, the newer ones as they are, with the
// composition of all of them.
//
// Cost: amortised O(1) an event whatever w. Memory: 24 bytes a segment inside the window.
#pragma once

#include "../algebra.hpp"
#include "kernel.hpp"
#include "merge.hpp"
#include "ring.hpp"

namespace rtamt::dense {

class Until final : public Temporal {
  public:
    Until(std::int64_t lag, std::int64_t width) noexcept
        : Temporal(lag, Max::identity), width_(width) {}

    std::int64_t run(std::int64_t frontier) override {
        const Events phi = a();
        const Events psi = b();
        const std::size_t arriving = phi.count + psi.count;
        const std::size_t due =
            window_.count_while([&](std::size_t i) { return expiry(i) <= frontier; });
        Writer out = open(due + 2 * arriving); // what arrives may leave again
        merge(phi, psi, state_.operands, [&](std::int64_t time, const Pair& now) {
            expire(out, time - 1);
            window_.push_back({time, {now.b, now.a}});
            state_.newer = state_.newer.after({now.b, now.a});
            while (expiry(0) <= time)
                leave();
            out.put(time, value());
        });
        expire(out, frontier);
        close(out, frontier);
        return never;
    }

    void checkpoint() noexcept override {
        Temporal::checkpoint();
        window_.checkpoint();
        saved_ = state_;
    }
    void rollback() noexcept override {
        Temporal::rollback();
        window_.rollback();
        state_ = saved_;
    }
    void transfer(Snapshot& snapshot, std::int64_t frontier) override {
        Temporal::transfer(snapshot, frontier);
        window_.transfer(snapshot);
        snapshot.item(state_);
        snapshot.require(state_.older <= window_.size());
        snapshot.require(window_.increasing(-never - 1, frontier, &Segment::begin));
        snapshot.require(window_.empty() || expiry(0) > frontier);
    }

    [[nodiscard]] std::size_t pending() const noexcept override { return window_.size(); }
    [[nodiscard]] std::size_t bytes() const noexcept override {
        return Temporal::bytes() + window_.bytes();
    }

  protected:
    void reset() noexcept override {
        Temporal::reset();
        window_.clear();
        state_ = {};
    }

  private:
    struct Segment {
        std::int64_t begin = 0;
        Clamp map;
    };
    struct State {
        Pair operands;         // phi and psi of the last segment
        std::size_t older = 0; // segments in the stack of the older ones
        Clamp newer;           // composition of the rest
    };
    std::int64_t width_;
    Ring<Segment> window_;
    State state_;
    State saved_;

    // When a segment leaves: w after its end, where the next one begins. The last one lasts.
    [[nodiscard]] std::int64_t expiry(std::size_t i) const noexcept {
        return i + 1 < window_.size() ? later(window_[i + 1].begin, width_) : never;
    }

    [[nodiscard]] double value() const noexcept {
        return state_.older != 0 ? window_.front().map.at(state_.newer.low) : state_.newer.low;
    }

    void expire(Writer& out, std::int64_t frontier) {
        for (std::int64_t time = expiry(0); time <= frontier && time != never; time = expiry(0)) {
            leave();
            out.put(time, value());
        }
    }

    void leave() {
        if (state_.older == 0) turn_over();
        window_.pop_front();
        --state_.older;
    }

    // All newer segments become older ones.
    void turn_over() {
        Clamp tail;
        for (std::size_t i = window_.size(); i > 0; --i) {
            Segment& segment = window_.edit(i - 1);
            tail = segment.map.after(tail);
            segment.map = tail;
        }
        state_.older = window_.size();
        state_.newer = {};
    }
};

} // namespace rtamt::dense
