// The last change of a node of an engine: runs of ticks and their new bounds.
#pragma once

#include "bounds_engine.hpp"
#include "state_checks.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <queue>
#include <span>
#include <utility>
#include <vector>

namespace rtamt::early {

// No minus before a zero, which would depend on the order of samples and on the engine.
[[nodiscard]] inline Bounds unsigned_zeros(const Bounds& bounds) noexcept {
    return {bounds.lower + 0.0, bounds.upper + 0.0};
}

struct BoundChange {
    Tick l;
    Tick r;
    Bounds bounds;
};

// Runs without overlap, in order: each tick has the bounds of its last run.
[[nodiscard]] inline std::vector<BoundChange> latest(std::span<const BoundChange> runs) {
    std::vector<std::size_t> begins(runs.size());
    std::vector<Tick> cuts;
    for (std::size_t i = 0; i < runs.size(); ++i) {
        begins[i] = i;
        cuts.insert(cuts.end(), {runs[i].l, runs[i].r + 1});
    }
    std::ranges::sort(begins, {}, [&](std::size_t i) { return runs[i].l; });
    std::ranges::sort(cuts);
    std::vector<BoundChange> found;
    std::priority_queue<std::size_t> open; // the last of these has its bounds
    std::size_t taken = 0;
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
        const Tick begin = cuts[i];
        const Tick last = cuts[i + 1] - 1;
        for (; taken < begins.size() && runs[begins[taken]].l <= begin; ++taken)
            open.push(begins[taken]);
        while (!open.empty() && runs[open.top()].r < begin)
            open.pop();
        if (open.empty() || last < begin) continue;
        const Bounds& bounds = runs[open.top()].bounds;
        if (!found.empty() && found.back().r == begin - 1 && found.back().bounds == bounds) {
            found.back().r = last;
        } else {
            found.push_back({begin, last, bounds});
        }
    }
    return found;
}

class BoundChanges {
  public:
    // Looks at a change, up to the newest sample: what is later waits. `before`: the newest sample
    // before it.
    void collect(const BoundsEngine& engine, std::uint32_t ref, Tick before, Tick newest) {
        changed_.clear();
        for (int reg = 0; reg < 2; ++reg) {
            for (const Piece& piece : engine.new_data(ref, reg)) {
                if (piece.l <= newest) changed_.emplace_back(piece.l, std::min(piece.r, newest));
            }
        }
        if (newest > before) changed_.emplace_back(before + 1, newest);
    }

    // Ticks of which the bounds are required as if they had changed.
    void add(Tick first, Tick last) { changed_.emplace_back(first, last); }

    // The first tick, `forever` where nothing changed.
    [[nodiscard]] Tick first() const noexcept {
        Tick first = forever;
        for (const auto& range : changed_)
            first = std::min(first, range.first);
        return first;
    }

    // In order, each as long as its bounds stay the same.
    [[nodiscard]] std::vector<BoundChange> runs(const BoundsEngine& engine,
                                                std::uint32_t ref) const {
        auto ranges = changed_;
        std::ranges::sort(ranges);
        std::vector<BoundChange> result;
        Tick next = 0;
        for (const auto& [first, last] : ranges) {
            for (Tick t = std::max(first, next); t <= last;) {
                const Run lower = engine.runs(ref, 0).at(t);
                const Run upper = engine.runs(ref, 1).at(t);
                const Bounds bounds{lower.value, -upper.value};
                const Tick end = std::min({last, lower.end, upper.end});
                if (!result.empty() && result.back().r == t - 1 && result.back().bounds == bounds) {
                    result.back().r = end;
                } else {
                    result.push_back({t, end, bounds});
                }
                t = end + 1;
            }
            next = std::max(next, last + 1);
        }
        return result;
    }

    void transfer(Snapshot& snapshot) {
        checked::list(snapshot, changed_, 2 * sizeof(Tick), [&](auto& range) {
            checked::tick(snapshot, range.first);
            checked::tick(snapshot, range.second, range.first);
        });
    }

  private:
    std::vector<std::pair<Tick, Tick>> changed_; // in any order, perhaps more than once
};

} // namespace rtamt::early
