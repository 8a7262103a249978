// The decided ticks of a node, each reported once: where its lower bound has become positive or its
// upper bound negative. What is decided before it is reached waits.
#pragma once

#include "bounds_engine.hpp"
#include "eager_engine.hpp"
#include "state_checks.hpp"

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

// Decisions, whose ticks a function transfers.
template <class Ticks>
void transfer(Snapshot& snapshot, std::vector<Decision>& decisions, const Ticks& ticks) {
    checked::list(snapshot, decisions, 3 * sizeof(Tick) + 1, [&](Decision& decision) {
        ticks(decision);
        checked::time(snapshot, decision.at);
        snapshot.item(decision.satisfied);
    });
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
    template <class Engine>
    void begin(const Engine& engine, std::uint32_t ref) {
        for (Tick t = 0; t < forever;) {
            const KleeneRuns::Run run = decided_at(engine, ref, t);
            if (run.value != Kleene::open) {
                waiting_.push_back({t, run.end, 0, run.value == Kleene::holds});
            }
            if (run.end >= forever) break;
            t = run.end + 1;
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
                take({piece.l, piece.r, at, satisfied}, newest, out);
            }
        }
        reach(newest, out);
    }
    void collect(const EagerEngine& engine, std::uint32_t ref, Tick newest, Tick at,
                 std::vector<Decision>& out) {
        const Kleene satisfies = (ref & 1U) == 0 ? Kleene::holds : Kleene::fails;
        for (const Decided& piece : engine.decided(ref))
            take({piece.l, piece.r, at, piece.value == satisfies}, newest, out);
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
    template <class Engine>
    [[nodiscard]] static Tick open(const Engine& engine, std::uint32_t ref, Tick from) noexcept {
        for (;;) {
            const KleeneRuns::Run run = decided_at(engine, ref, from);
            if (run.value == Kleene::open) return from;
            if (run.end >= forever) return forever;
            from = run.end + 1;
        }
    }

    // The first sample whose time will be reported.
    [[nodiscard]] Tick oldest() const noexcept { return oldest_of(waiting_); }

    [[nodiscard]] std::size_t bytes() const noexcept { return waiting_.size() * sizeof(Decision); }

    void transfer(Snapshot& snapshot) {
        Tick end = 0;
        early::transfer(snapshot, waiting_, [&](Decision& decision) {
            checked::run(snapshot, decision.l, decision.r, end);
        });
    }

  private:
    std::vector<Decision> waiting_; // by their first ticks, which they share with no other

    void take(const Decision& decision, Tick newest, std::vector<Decision>& out) {
        if (decision.r <= newest) {
            out.push_back(decision);
        } else {
            waiting_.insert(std::ranges::upper_bound(waiting_, decision.l, {}, &Decision::l),
                            decision);
        }
    }

    // What is decided around a tick.
    [[nodiscard]] static KleeneRuns::Run decided_at(const EagerEngine& engine, std::uint32_t ref,
                                                    Tick t) noexcept {
        return engine.at(ref, t);
    }
    [[nodiscard]] static KleeneRuns::Run decided_at(const BoundsEngine& engine, std::uint32_t ref,
                                                    Tick t) noexcept {
        const Run lower = engine.runs(ref, 0).at(t);
        const Run upper = engine.runs(ref, 1).at(t);
        Kleene value = Kleene::open;
        if (lower.value > 0) value = Kleene::holds;
        if (upper.value > 0) value = Kleene::fails;
        return {std::max(lower.begin, upper.begin), std::min(lower.end, upper.end), value};
    }
};

} // namespace rtamt::early
