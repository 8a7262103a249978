// Extremum over the last w ticks, the closed window [s - w, s]: bounded once, historically,
// eventually, always.
//
// A segment [p, q) of the operand counts for s in [p, q + w). A monotonic wedge (D. Lemire,
// "Streaming maximum-minimum filter using no more than three comparisons per element", 2006) with
// expiry times: segments in the order of time, each better than all after it, so that the first is
// the extremum. A new segment outlives those before it and removes the ones that are no better.
// That takes values of which one is always the better; where they are not so ordered, the window is
// one of two stacks (sliding.hpp).
//
// Cost: amortised O(1) an event whatever w. Memory: at most the segments inside the window.
#pragma once

#include "../values/algebra.hpp"
#include "kernel.hpp"
#include "ring.hpp"
#include "sliding.hpp"

#include <type_traits>

namespace rtamt::dense {

template <class Algebra>
class Wedge final : public Temporal<typename Algebra::Domain> {
  public:
    using Value = typename Algebra::Value;
    using Base = Temporal<typename Algebra::Domain>;
    using Writer = typename Base::Writer;
    static_assert(Algebra::Domain::total);

    Wedge(std::int64_t lag, std::int64_t width) noexcept
        : Base(lag, Algebra::identity), width_(width) {}

    std::int64_t run(std::int64_t frontier) override {
        const BasicEvents<Value> a = Kernel::a<Value>();
        const std::size_t due =
            wedge_.count_while([&](std::size_t i) { return wedge_[i].expiry <= frontier; });
        Writer out = this->open(due + 2 * a.count); // what arrives may leave again
        if (wedge_.pinned()) {
            slide(wedge_, a, frontier, out);
        } else {
            auto loose = wedge_.loosen(a.count);
            slide(loose, a, frontier, out);
            wedge_.fasten(loose);
        }
        this->close(out, frontier);
        return never;
    }

    void checkpoint() noexcept override {
        Base::checkpoint();
        wedge_.checkpoint();
    }
    void rollback() noexcept override {
        Base::rollback();
        wedge_.rollback();
    }
    void transfer(Snapshot& snapshot, std::int64_t frontier) override {
        Base::transfer(snapshot, frontier);
        wedge_.transfer(snapshot);
        snapshot.require(wedge_.empty() || wedge_.back().expiry == never);
        snapshot.require(wedge_.increasing(frontier, never, &Segment::expiry));
        snapshot.require(wedge_.size() < 2 ||
                         wedge_[wedge_.size() - 2].expiry <= later(frontier, width_));
    }

    [[nodiscard]] std::size_t pending() const noexcept override { return wedge_.size(); }
    [[nodiscard]] std::size_t bytes() const noexcept override {
        return Base::bytes() + wedge_.bytes();
    }

  protected:
    void reset() noexcept override {
        Base::reset();
        wedge_.clear();
    }

  private:
    struct Segment {
        std::int64_t expiry; // when it leaves the window; never, as long as it lasts
        Value value;
    };
    std::int64_t width_;
    Ring<Segment> wedge_;

    // All changes up to the frontier; `wedge` is the ring, or what it is loosened to.
    template <class Cells>
    void slide(Cells& wedge, const BasicEvents<Value>& a, std::int64_t frontier, Writer& result) {
        Writer out = result; // which no store can change
        for (std::size_t i = 0; i < a.count; ++i) {
            const std::int64_t time = a.times[i];
            while (!wedge.empty() && wedge.front().expiry < time)
                expire(wedge, out);
            arrive(wedge, time, a.values[i]);
            if (wedge.front().expiry <= time) wedge.pop_front();
            out.put(time, wedge.front().value);
        }
        while (!wedge.empty() && wedge.front().expiry <= frontier)
            expire(wedge, out);
        result = out;
    }

    // The first segment leaves; the one that lasts never does, so there is another.
    template <class Cells>
    static void expire(Cells& wedge, Writer& out) noexcept {
        const std::int64_t time = wedge.front().expiry;
        wedge.pop_front();
        out.put(time, wedge.front().value);
    }

    template <class Cells>
    void arrive(Cells& wedge, std::int64_t time, Value value) {
        if (!wedge.empty()) {
            const Value last = wedge.back().value;
            if (last == value) return; // the segment continues
            if (Algebra::join(last, value) != value) {
                wedge.edit_back().expiry = later(time, width_);
            } else {
                do {
                    wedge.pop_back();
                } while (!wedge.empty() && Algebra::join(wedge.back().value, value) == value);
            }
        }
        wedge.push_back({never, value});
    }
};

template <class Algebra>
using Slide = std::conditional_t<Algebra::Domain::total, Wedge<Algebra>,
                                 Sliding<Joined<Algebra>, typename Algebra::Domain>>;

} // namespace rtamt::dense
