// A step function of time as its maximal runs, in an ordered map.
//
// Runs lie in chunks; a directory keeps the first tick of each chunk. The last run continues for
// ever; runs that nothing needs any more are dropped at the front.
//
// Cost: a search in the directory and one in a chunk for each access; a chunk is moved in part when
// a border is added or removed. Memory: a tick and a value for each run.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
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

template <class Value>
class StepMap {
  public:
    struct Run {
        Tick begin;
        Tick end; // the last tick
        Value value;
    };

    // One value for ever, from a tick on.
    StepMap(Tick from, const Value& value);

    StepMap(const StepMap& other);
    StepMap& operator=(const StepMap& other);
    StepMap(StepMap&&) noexcept = default;
    StepMap& operator=(StepMap&&) noexcept = default;
    ~StepMap() = default;

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
    void set(Tick l, Tick r, const Value& value) { set(find(l), l, r, value); }
    void set(Place p, Tick l, Tick r, const Value& value);

    // The last run, which goes on for ever.
    [[nodiscard]] Run last_run() const noexcept {
        const Chunk& chunk = *directory_.back().chunk;
        return {chunk.start[chunk.end - 1], forever, chunk.value[chunk.end - 1]};
    }
    // Gives a new value to the tick at which it begins, and to that alone.
    void extend(const Value& value);

    // Drops the runs that end before a tick.
    void drop_before(Tick t) noexcept;

    // The first tick that is held.
    [[nodiscard]] Tick front() const noexcept { return directory_[head_].first; }

    [[nodiscard]] std::size_t bytes() const noexcept {
        return (directory_.size() - head_) * sizeof(Chunk);
    }

    void transfer(Snapshot& snapshot);

  protected:
    static constexpr int capacity = 64;
    static constexpr std::size_t grouped = 32; // chunks

    struct Chunk {
        int begin = 0; // runs [begin, end) are in use
        int end = 0;
        Tick start[capacity] = {};
        Value value[capacity] = {};
    };
    // What searches for values have found out, for as long as nothing changes.
    struct Summary {
        Value least{};
        Value most{};
        bool valid = false;
    };
    struct Entry {
        Tick first = 0;
        mutable Summary summary;
        std::unique_ptr<Chunk> chunk;
    };

    std::vector<Entry> directory_;        // never empty, and neither is a chunk from the head on
    std::size_t head_ = 0;                // chunks before it are dropped
    mutable std::vector<Summary> groups_; // of so many chunks each

    void changed(std::size_t chunk) noexcept;
    // The last run of a chunk that begins at a tick or before, or its first run.
    [[nodiscard]] static int find(const Chunk& chunk, Tick t) noexcept;
    // Gives one value to runs [place, right) of a chunk from a tick on up to r; `rest` is the value
    // behind r. The chunk has room for two more.
    static void replace(Chunk& chunk, int place, int right, Tick l, Tick r, const Value& value,
                        const Value& rest) noexcept;
    [[nodiscard]] std::optional<Place> before(Place p) const noexcept;
    [[nodiscard]] std::optional<Place> after(Place p) const noexcept;
    [[nodiscard]] Value& value_at(Place p) noexcept {
        return directory_[p.chunk].chunk->value[p.index];
    }
    void erase(Place p) noexcept;
    // Drops the chunks without runs from an index on.
    void drop_empty(std::size_t from) noexcept;

  private:
    [[nodiscard]] Tick end_of(Place p) const noexcept;
    void moved(std::size_t chunk);
    void move_start(Place p, Tick start) noexcept;
    Place insert_after(Place p, Tick start, const Value& value);
    void append(Tick start, const Value& value);
};

// What the values of a chunk are is not what it was.
template <class Value>
inline void StepMap<Value>::changed(std::size_t chunk) noexcept {
    directory_[chunk].summary.valid = false;
    if (chunk / grouped < groups_.size()) groups_[chunk / grouped].valid = false;
}

// ---- accesses -----------------------------------------------------------------------------------

template <class Value>
inline auto StepMap<Value>::find(Tick t) const noexcept -> Place {
    std::size_t c = directory_.size() - 1;
    if (directory_[c].first > t) {
        std::size_t low = head_;
        while (low < c) { // the last chunk that begins at t or before, or the first chunk
            const std::size_t middle = (low + c + 1) / 2;
            if (directory_[middle].first <= t) {
                low = middle;
            } else {
                c = middle - 1;
            }
        }
    }
    return {c, find(*directory_[c].chunk, t)};
}

template <class Value>
inline int StepMap<Value>::find(const Chunk& chunk, Tick t) noexcept {
    int high = chunk.end - 1;
    if (chunk.start[high] > t) {
        constexpr int near = 8;
        int low = chunk.begin;
        --high;
        if (high - low >= near && chunk.start[high - near] <= t) { // most accesses are near the end
            int later = 0;
            for (int i = 0; i < near; ++i) // without branches, which are unpredictable
                later += chunk.start[high - i] > t ? 1 : 0;
            return high - later;
        }
        for (int count = high - low + 1; count > 1;) {
            const int half = count / 2;
            low += chunk.start[low + half] <= t ? half : 0;
            count -= half;
        }
        high = low < chunk.begin ? chunk.begin : low;
    }
    return high;
}

template <class Value>
inline Tick StepMap<Value>::end_of(Place p) const noexcept {
    const Chunk& chunk = *directory_[p.chunk].chunk;
    if (p.index + 1 < chunk.end) return chunk.start[p.index + 1] - 1;
    return p.chunk + 1 < directory_.size() ? directory_[p.chunk + 1].first - 1 : forever;
}

template <class Value>
inline void StepMap<Value>::replace(Chunk& chunk, int place, int right, Tick l, Tick r,
                                    const Value& value, const Value& rest) noexcept {
    const bool splits = chunk.start[place] < l;
    if (splits) ++place;
    const bool joins = !splits && place > chunk.begin && chunk.value[place - 1] == value;
    const bool leaves = right == chunk.end || chunk.start[right] > r + 1; // a rest of the last one
    const int next = place + (joins ? 0 : 1) + (leaves ? 1 : 0);
    if (right < chunk.end) {
        right += !leaves && chunk.value[right] == value ? 1 : 0; // which continues with this value
        constexpr int few = 8;
        if (chunk.end - right <= few && std::max(right, next) + few <= capacity) {
            // As many at once, whatever they are: the number of those there are is unpredictable.
            std::array<Tick, few> starts{};
            std::array<Value, few> values{};
            std::copy_n(chunk.start + right, few, starts.begin());
            std::copy_n(chunk.value + right, few, values.begin());
            std::copy_n(starts.begin(), few, chunk.start + next);
            std::copy_n(values.begin(), few, chunk.value + next);
        } else if (next > right) {
            std::copy_backward(chunk.start + right, chunk.start + chunk.end,
                               chunk.start + chunk.end + (next - right));
            std::copy_backward(chunk.value + right, chunk.value + chunk.end,
                               chunk.value + chunk.end + (next - right));
        } else if (next < right) {
            std::copy(chunk.start + right, chunk.start + chunk.end, chunk.start + next);
            std::copy(chunk.value + right, chunk.value + chunk.end, chunk.value + next);
        }
    }
    chunk.end += next - right;
    // Without branches, which are unpredictable.
    place -= joins ? 1 : 0;
    chunk.start[place] = joins ? chunk.start[place] : l;
    chunk.value[place] = value;
    chunk.start[place + 1] = leaves ? r + 1 : chunk.start[place + 1];
    chunk.value[place + 1] = leaves ? rest : chunk.value[place + 1];
}

// What samples in order do.
template <class Value>
inline void StepMap<Value>::extend(const Value& value) {
    Entry& entry = directory_.back();
    Chunk& chunk = *entry.chunk;
    const int last = chunk.end - 1;
    const Value rest = chunk.value[last];
    if (last == chunk.begin || chunk.end == capacity || rest == value) {
        const Tick t = chunk.start[last];
        return set({directory_.size() - 1, last}, t, t, value);
    }
    const Tick next = chunk.start[last] + 1;
    if (chunk.value[last - 1] == value) {
        chunk.start[last] = next;
        return;
    }
    chunk.value[last] = value;
    chunk.start[chunk.end] = next;
    chunk.value[chunk.end++] = rest;
    changed(directory_.size() - 1);
}

template <class Value>
inline auto StepMap<Value>::run(Place p) const noexcept -> Run {
    const Chunk& chunk = *directory_[p.chunk].chunk;
    return {chunk.start[p.index], end_of(p), chunk.value[p.index]};
}

} // namespace rtamt::early
