// The decided ticks of a node, each reported once: where its lower bound has become positive or its
// upper bound negative. What is decided before it is reached waits.
#pragma once

#include "../program/snapshot.hpp"
#include "bounds_engine.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace rtamt::early {

// Ticks [l, r], decided by the sample at `at`.
struct Decision {
    Tick l;
    Tick r;
    Tick at;
    bool satisfied;
};

inline void transfer(Snapshot& snapshot, std::vector<Decision>& decisions) {
    std::size_t size = decisions.size();
    snapshot.count(size, 3 * sizeof(Tick) + 1);
    decisions.resize(size);
    for (Decision& decision : decisions) {
        snapshot.item(decision.l);
        snapshot.item(decision.r);
        snapshot.item(decision.at);
        snapshot.item(decision.satisfied);
    }
}

// The first sample whose time is that of a decision.
[[nodiscard]] inline Tick oldest_of(const std::vector<Decision>& decisions) noexcept {
    Tick oldest = forever;
    for (const Decision& decision : decisions)
        oldest = std::min({oldest, decision.l, decision.at});
    return oldest;
}

class EagerVerdicts {
  public:
    // The verdicts decided before any sample; they get the time of the first.
    void begin(const BoundsEngine& engine, std::uint32_t ref) {
        for (Tick t = 0; t < forever;) {
            const Run lower = engine.runs(ref, 0).at(t);
            const Run upper = engine.runs(ref, 1).at(t);
            const Tick end = std::min(lower.end, upper.end);
            if (lower.value > 0 || upper.value > 0) {
                waiting_.push_back({t, end, 0, lower.value > 0});
            }
            if (end >= forever) break;
            t = end + 1;
        }
    }

    void date(Tick at) noexcept {
        for (Decision& decision : waiting_)
            decision.at = at;
    }

    // Takes what the last change of the engine decided, by the sample at `at`; gives what is
    // decided up to `newest`.
    void collect(const BoundsEngine& engine, std::uint32_t ref, Tick newest, Tick at,
                 std::vector<Decision>& out) {
        for (const bool satisfied : {true, false}) {
            for (const Piece& piece : engine.new_data(ref, satisfied ? 0 : 1)) {
                if (piece.old > 0 || !(piece.now > 0)) continue;
                const Decision decision{piece.l, piece.r, at, satisfied};
                if (piece.r <= newest) {
                    out.push_back(decision);
                } else {
                    waiting_.insert(std::ranges::upper_bound(waiting_, piece.l, {}, &Decision::l),
                                    decision);
                }
            }
        }
        reach(newest, out);
    }

    // Gives what is decided and reached.
    void reach(Tick newest, std::vector<Decision>& out) {
        std::size_t done = 0;
        for (Decision& decision : waiting_) {
            if (decision.l > newest) break;
            const Tick last = std::min(decision.r, newest);
            out.push_back({decision.l, last, decision.at, decision.satisfied});
            decision.l = last + 1;
            if (decision.l > decision.r) ++done;
        }
        if (done == 0) return;
        waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(done));
    }

    // The first tick that is not decided.
    [[nodiscard]] static Tick open(const BoundsEngine& engine, std::uint32_t ref,
                                   Tick from) noexcept {
        for (;;) {
            const Run lower = engine.runs(ref, 0).at(from);
            const Run upper = engine.runs(ref, 1).at(from);
            if (!(lower.value > 0) && !(upper.value > 0)) return from;
            const Tick end = lower.value > 0 ? lower.end : upper.end;
            if (end >= forever) return forever;
            from = end + 1;
        }
    }

    // The first sample whose time will be reported.
    [[nodiscard]] Tick oldest() const noexcept { return oldest_of(waiting_); }

    [[nodiscard]] std::size_t bytes() const noexcept { return waiting_.size() * sizeof(Decision); }

    void transfer(Snapshot& snapshot) { rtamt::early::transfer(snapshot, waiting_); }

  private:
    std::vector<Decision> waiting_; // by their first ticks, which they share with no other
};

} // namespace rtamt::early
