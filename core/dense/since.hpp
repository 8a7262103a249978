// Unbounded since, segment by segment of the two operands merged.
//
// On a segment with phi = p and psi = q, psi may have held best before it, which phi must have
// outlasted, now too, or it holds now: S = max(q, min(p, C)), where C is what the segments before
// leave. To the next segment it leaves C' = min(p, max(q, C)): unlike in discrete time, p counts
// even for the psi of its own segment, because (t', t] contains the rest of the segment of t'.
//
// Cost: four comparisons an event. Memory: three doubles.
#pragma once

#include "../algebra.hpp"
#include "kernel.hpp"
#include "merge.hpp"

namespace rtamt::dense {

class Since final : public Temporal {
  public:
    explicit Since(std::int64_t lag) noexcept : Temporal(lag, Max::identity) {}

    std::int64_t run(std::int64_t frontier) override {
        const Events phi = a();
        const Events psi = b();
        Writer out = open(phi.count + psi.count);
        Pair segment = state_.operands;
        double carry = state_.carry;
        merge(phi, psi, state_.operands, [&](std::int64_t time, const Pair& now) {
            carry = Min::join(segment.a, Max::join(segment.b, carry));
            segment = now;
            out.put(time, Max::join(now.b, Min::join(now.a, carry)));
        });
        state_.carry = carry;
        close(out, frontier);
        return never;
    }

    void checkpoint() noexcept override {
        Temporal::checkpoint();
        saved_ = state_;
    }
    void rollback() noexcept override {
        Temporal::rollback();
        state_ = saved_;
    }
    void transfer(Snapshot& snapshot, std::int64_t frontier) override {
        Temporal::transfer(snapshot, frontier);
        snapshot.item(state_);
    }

  protected:
    void reset() noexcept override {
        Temporal::reset();
        state_ = {};
    }

  private:
    struct State {
        Pair operands{Max::identity, Max::identity}; // phi and psi of the last segment
        double carry = Max::identity;                // what the segments before it leave
    };
    State state_;
    State saved_;
};

} // namespace rtamt::dense
