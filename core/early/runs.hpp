// A step function of time as its maximal runs, in an ordered map: what one register of a node
// holds.
//
// Runs lie in chunks; a directory keeps the first tick and the least and the greatest value of each
// chunk, and those of groups of chunks, so that a search passes over what it need not look into.
// The last run goes on for ever; runs that nothing needs any more are dropped at the front.
//
// Cost: a search in the directory and one in a chunk for each access; a chunk is moved in part when
// a border is added or removed. Memory: two words a run.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace rtamt {
class Snapshot;
}

namespace rtamt::early {

using Tick = std::int64_t;

// Beyond every tick, and far enough from the end of the type for sums of two.
inline constexpr Tick forever = std::numeric_limits<Tick>::max() / 4;

// Sums in which `forever` stays what it is, with either sign.
[[nodiscard]] constexpr Tick plus(Tick a, Tick b) noexcept {
    if (a >= forever || b >= forever) return forever;
    if (a <= -forever || b <= -forever) return -forever;
    return a + b;
}

struct Run {
    Tick begin;
    Tick end; // the last tick
    double value;
};

// What a search looks for, by comparison with a value; `possible` whether a chunk may hold it.
struct Below {
    static bool holds(double x, double value) noexcept { return x < value; }
    static bool possible(double least, double /*most*/, double value) noexcept {
        return least < value;
    }
};
struct Above {
    static bool holds(double x, double value) noexcept { return x > value; }
    static bool possible(double /*least*/, double most, double value) noexcept {
        return most > value;
    }
};
struct AtMost {
    static bool holds(double x, double value) noexcept { return x <= value; }
    static bool possible(double least, double /*most*/, double value) noexcept {
        return least <= value;
    }
};
struct AtLeast {
    static bool holds(double x, double value) noexcept { return x >= value; }
    static bool possible(double /*least*/, double most, double value) noexcept {
        return most >= value;
    }
};

class Runs {
  public:
    // One value for ever, from a tick on.
    explicit Runs(Tick from = 0, double value = -std::numeric_limits<double>::infinity());

    Runs(const Runs& other);
    Runs& operator=(const Runs& other);
    Runs(Runs&&) noexcept = default;
    Runs& operator=(Runs&&) noexcept = default;
    ~Runs() = default;

    // Where a run lies, until the next change.
    struct Place {
        std::size_t chunk;
        int index;
    };

    // The run in which a tick lies; the first one for ticks that were dropped.
    [[nodiscard]] Place find(Tick t) const noexcept;
    [[nodiscard]] Run run(Place p) const noexcept;
    [[nodiscard]] Run at(Tick t) const noexcept { return run(find(t)); }

    // Gives a new value to [l, r], which lies in one run.
    void set(Tick l, Tick r, double value) { set(find(l), l, r, value); }
    void set(Place p, Tick l, Tick r, double value);

    // The first or the last run, cut to [l, r], whose value compares so with a value.
    template <class Search>
    [[nodiscard]] std::optional<Run> first(Tick l, Tick r, double value) const noexcept;
    template <class Search>
    [[nodiscard]] std::optional<Run> last(Tick l, Tick r, double value) const noexcept;

    // The least and the greatest value in [l, r]; or any there that is not above `floor`.
    [[nodiscard]] double
    least(Tick l, Tick r, double floor = -std::numeric_limits<double>::infinity()) const noexcept;
    [[nodiscard]] double most(Tick l, Tick r) const noexcept;

    // Drops the runs that end before a tick.
    void drop_before(Tick t) noexcept;

    // The first tick that is held.
    [[nodiscard]] Tick front() const noexcept { return directory_.front().first; }

    [[nodiscard]] std::size_t bytes() const noexcept { return directory_.size() * sizeof(Chunk); }

    void transfer(Snapshot& snapshot);

  private:
    static constexpr int capacity = 64;

    struct Chunk {
        int begin = 0; // runs [begin, end) are in use
        int end = 0;
        Tick start[capacity] = {};
        double value[capacity] = {};
    };
    struct Entry {
        Tick first = 0;
        mutable double least = 0;
        mutable double most = 0;
        mutable bool summed = false; // whether least and most are those of the chunk
        std::unique_ptr<Chunk> chunk;
    };
    struct Group {
        double least = 0;
        double most = 0;
        bool summed = false;
    };
    static constexpr std::size_t grouped = 32; // chunks

    std::vector<Entry> directory_; // never empty, and neither is a chunk in it
    mutable std::vector<Group> groups_;

    [[nodiscard]] Tick end_of(Place p) const noexcept;
    [[nodiscard]] std::optional<Place> before(Place p) const noexcept;
    [[nodiscard]] std::optional<Place> after(Place p) const noexcept;
    [[nodiscard]] double& value_at(Place p) noexcept {
        return directory_[p.chunk].chunk->value[p.index];
    }
    void sum(const Entry& entry) const noexcept;
    // Of as many chunks as there are in a group, the first one's index a multiple of that.
    [[nodiscard]] const Group& group_from(std::size_t chunk) const noexcept;
    void changed(std::size_t chunk) noexcept;
    void moved(std::size_t chunk);
    void move_start(Place p, Tick start) noexcept;
    void erase(Place p) noexcept;
    Place insert_after(Place p, Tick start, double value);
    void append(Tick start, double value);
    template <bool greatest>
    [[nodiscard]] double extreme(Tick l, Tick r, double enough) const noexcept;
};

// ---- searches -----------------------------------------------------------------------------------

inline Runs::Place Runs::find(Tick t) const noexcept {
    std::size_t c = directory_.size() - 1;
    if (directory_[c].first > t) {
        std::size_t low = 0;
        while (low < c) { // the last chunk that begins at t or before, or the first chunk
            const std::size_t middle = (low + c + 1) / 2;
            if (directory_[middle].first <= t) {
                low = middle;
            } else {
                c = middle - 1;
            }
        }
    }
    const Chunk& chunk = *directory_[c].chunk;
    int high = chunk.end - 1;
    if (chunk.start[high] > t) {
        int low = chunk.begin;
        --high;
        if (high >= low && chunk.start[high] <= t) low = high; // most accesses are near the end
        for (int count = high - low + 1; count > 1;) { // without branches, which nobody predicts
            const int half = count / 2;
            low += chunk.start[low + half] <= t ? half : 0;
            count -= half;
        }
        high = low < chunk.begin ? chunk.begin : low;
    }
    return {c, high};
}

inline Tick Runs::end_of(Place p) const noexcept {
    const Chunk& chunk = *directory_[p.chunk].chunk;
    if (p.index + 1 < chunk.end) return chunk.start[p.index + 1] - 1;
    return p.chunk + 1 < directory_.size() ? directory_[p.chunk + 1].first - 1 : forever;
}

inline Run Runs::run(Place p) const noexcept {
    const Chunk& chunk = *directory_[p.chunk].chunk;
    return {chunk.start[p.index], end_of(p), chunk.value[p.index]};
}

template <class Search>
std::optional<Run> Runs::first(Tick l, Tick r, double value) const noexcept {
    if (l > r) return std::nullopt;
    const auto cut = [&](Place p) {
        const Run found = run(p);
        return Run{found.begin < l ? l : found.begin, found.end > r ? r : found.end, found.value};
    };
    Place p = find(l);
    for (;; p.index = 0) {
        const Entry& entry = directory_[p.chunk];
        const Chunk& chunk = *entry.chunk;
        if (p.index == 0) p.index = chunk.begin;
        for (; p.index < chunk.end; ++p.index) {
            if (chunk.start[p.index] > r) return std::nullopt;
            if (Search::holds(chunk.value[p.index], value)) return cut(p);
        }
        for (;;) { // to the next chunk that may hold one
            ++p.chunk;
            if (p.chunk == directory_.size() || directory_[p.chunk].first > r) return std::nullopt;
            if (p.chunk % grouped == 0 && p.chunk + grouped < directory_.size()) {
                const Group& group = group_from(p.chunk);
                if (!Search::possible(group.least, group.most, value)) {
                    p.chunk += grouped - 1;
                    continue;
                }
            }
            const Entry& next = directory_[p.chunk];
            if (!next.summed) sum(next);
            if (Search::possible(next.least, next.most, value)) break;
        }
    }
}

template <class Search>
std::optional<Run> Runs::last(Tick l, Tick r, double value) const noexcept {
    if (l > r) return std::nullopt;
    Place p = find(r);
    for (;;) {
        const Chunk& chunk = *directory_[p.chunk].chunk;
        for (; p.index >= chunk.begin; --p.index) {
            if (Search::holds(chunk.value[p.index], value)) {
                const Run found = run(p);
                if (found.end < l) return std::nullopt;
                return Run{found.begin < l ? l : found.begin, found.end > r ? r : found.end,
                           found.value};
            }
            if (chunk.start[p.index] <= l) return std::nullopt;
        }
        for (;;) {
            if (p.chunk == 0) return std::nullopt;
            --p.chunk;
            if (p.chunk % grouped == grouped - 1) {
                const std::size_t begin = p.chunk + 1 - grouped;
                const Group& group = group_from(begin);
                if (!Search::possible(group.least, group.most, value)) {
                    if (directory_[begin].first <= l) return std::nullopt;
                    p.chunk = begin;
                    continue;
                }
            }
            const Entry& next = directory_[p.chunk];
            if (!next.summed) sum(next);
            if (Search::possible(next.least, next.most, value)) break;
            if (next.first <= l) return std::nullopt;
        }
        p.index = directory_[p.chunk].chunk->end - 1;
    }
}

} // namespace rtamt::early
