// Unbounded since, segment by segment of the two operands merged.
//
// On a segment with phi = p and psi = q, psi may have held best before it, which phi must have
// outlasted, now too, or it holds now: S = max(q, min(p, C)), where C is what the segments before
// leave. To the next segment it leaves C' = min(p, max(q, C)): unlike in discrete time, p counts
// even for the psi of its own segment, because (t', t] contains the rest of the segment of t'.
//
// Cost: four comparisons an event. Memory: three values.
#pragma once

#include "kernel.hpp"
#include "merge.hpp"

namespace rtamt::dense {

template <class D>
struct SinceState {
    Pair<typename D::Value> operands{D::bottom, D::bottom}; // phi and psi of the last segment
    typename D::Value carry = D::bottom;                    // what the segments before it leave
};

template <ValueDomain D>
class Since final : public Temporal<D, SinceState<D>> {
  public:
    using Value = typename D::Value;

    explicit Since(std::int64_t lag) noexcept : Temporal<D, SinceState<D>>(lag, D::bottom) {}

    std::int64_t run(std::int64_t frontier) override {
        const BasicEvents<Value> phi = Kernel::a<Value>();
        const BasicEvents<Value> psi = Kernel::b<Value>();
        auto out = this->open(phi.count + psi.count);
        SinceState<D>& state = this->own();
        Pair<Value> segment = state.operands;
        Value carry = state.carry;
        merge(phi, psi, state.operands, [&](std::int64_t time, const Pair<Value>& now) {
            carry = D::meet(segment.a, D::join(segment.b, carry));
            segment = now;
            out.put(time, D::join(now.b, D::meet(now.a, carry)));
        });
        state.carry = carry;
        this->close(out, frontier);
        return never;
    }
};

} // namespace rtamt::dense
