// A step function of numbers: what one register of a node holds.
//
// The least and the greatest value of each chunk, and those of groups of chunks, are kept, so that
// a search passes over what it need not look into.
#pragma once

#include "step_map.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <optional>

namespace rtamt::early {

using Run = StepMap<double>::Run;

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

class Runs : public StepMap<double> {
  public:
    // One value for ever, from a tick on.
    explicit Runs(Tick from = 0, double value = -std::numeric_limits<double>::infinity())
        : StepMap(from, value) {}

    // The first or the last run, cut to [l, r], whose value compares so with a value.
    template <class Search>
    [[nodiscard]] std::optional<Run> first(Tick l, Tick r, double value) const noexcept;
    template <class Search>
    [[nodiscard]] std::optional<Run> last(Tick l, Tick r, double value) const noexcept;

    // The least and the greatest value in [l, r]; or any there that is not above `floor`.
    [[nodiscard]] double
    least(Tick l, Tick r, double floor = -std::numeric_limits<double>::infinity()) const noexcept;
    [[nodiscard]] double most(Tick l, Tick r) const noexcept;

    // Raises all values in [l, r] that are below this one, where values from l to r never rise;
    // calls `raised` with each run as it was. Returns false, with nothing done, unless r and all
    // that is raised lie in the last chunk, which has room.
    template <class Raised>
    [[nodiscard]] bool raise_end(Tick l, Tick r, double value, Raised&& raised);
    // Raises all values in [l, r] that are below this one, in the order of time, and calls `raised`
    // with each run as it was; `place` is that of l. Returns false, with nothing done, if only a
    // part of a run would rise.
    template <class Raised>
    [[nodiscard]] bool raise(Place place, Tick l, Tick r, double value, Raised&& raised);

  private:
    void sum(const Entry& entry) const noexcept;
    // Of as many chunks as there are in a group, the first one's index a multiple of that.
    [[nodiscard]] const Summary& group_from(std::size_t chunk) const noexcept;
    // How many chunks from one on, before an end, hold no value below this one: as many as are
    // looked at together.
    [[nodiscard]] std::size_t not_below(std::size_t chunk, std::size_t end,
                                        double value) const noexcept;
    template <bool greatest>
    [[nodiscard]] double extreme(Tick l, Tick r, double enough) const noexcept;
};

// ---- changes ------------------------------------------------------------------------------------

template <class Raised>
bool Runs::raise_end(Tick l, Tick r, double value, Raised&& raised) {
    Entry& entry = directory_.back();
    Chunk& chunk = *entry.chunk;
    const int last = chunk.end - 1;
    if (entry.first > r) return false;
    int place = find(chunk, r);
    const double rest = chunk.value[place];
    if (!(rest < value)) return true;
    const int right = place + 1;                         // the first run behind those raised
    while (place > chunk.begin && chunk.start[place] > l // the first run that is raised
           && chunk.value[place - 1] < value)
        --place;
    if ((place == chunk.begin && directory_.size() > head_ + 1) || last + 2 >= capacity)
        return false;
    const Tick begin = chunk.start[place] < l ? l : chunk.start[place];
    for (int i = place; i < right; ++i) {
        raised(Run{i == place ? begin : chunk.start[i], i < right - 1 ? chunk.start[i + 1] - 1 : r,
                   chunk.value[i]});
    }
    replace(chunk, place, right, begin, r, value, rest);
    changed(directory_.size() - 1);
    return true;
}

template <class Raised>
bool Runs::raise(Place place, Tick l, Tick r, double value, Raised&& raised) {
    const Place last = find(r);
    const auto rises_in_part = [&](Place p) {
        const Run found = run(p);
        return found.value < value && (found.begin < l || found.end > r);
    };
    if (rises_in_part(place) || rises_in_part(last)) return false;
    const auto previous = before(place);
    const auto next = after(last);
    double left = previous ? value_at(*previous) : std::numeric_limits<double>::quiet_NaN();
    bool emptied = false;                                       // a chunk
    const auto shorten = [&](std::size_t c, int from, int to) { // drops the runs [from, to)
        Chunk& chunk = *directory_[c].chunk;
        for (; to < chunk.end; ++from, ++to) {
            chunk.start[from] = chunk.start[to];
            chunk.value[from] = chunk.value[to];
        }
        chunk.end = from;
        emptied = emptied || chunk.begin == chunk.end;
        directory_[c].first = chunk.start[chunk.begin];
        changed(c);
    };
    for (std::size_t c = place.chunk; c <= last.chunk; ++c) {
        Chunk& chunk = *directory_[c].chunk;
        if (c > place.chunk && c < last.chunk && chunk.value[chunk.begin] != left) {
            if (const std::size_t passed = not_below(c, last.chunk, value); passed > 0) {
                c += passed - 1;
                left = directory_[c].chunk->value[directory_[c].chunk->end - 1];
                continue;
            }
        }
        const int end = c < last.chunk ? chunk.end : last.index + 1;
        int i = c > place.chunk ? chunk.begin : place.index;
        int to = i;
        for (; i < end; ++i) {
            Run found = run({c, i});
            if (found.value < value) {
                raised(found);
                found.value = value;
            }
            chunk.start[to] = found.begin;
            chunk.value[to] = found.value;
            to += found.value == left ? 0 : 1;
            left = found.value;
        }
        shorten(c, to, end < chunk.end && chunk.value[end] == left ? end + 1 : end);
    }
    if (next && next->chunk > last.chunk && value_at(*next) == left) erase(*next);
    if (emptied) drop_empty(place.chunk);
    return true;
}

// ---- searches -----------------------------------------------------------------------------------

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
                const Summary& group = group_from(p.chunk);
                if (!Search::possible(group.least, group.most, value)) {
                    p.chunk += grouped - 1;
                    continue;
                }
            }
            const Entry& next = directory_[p.chunk];
            if (!next.summary.valid) sum(next);
            if (Search::possible(next.summary.least, next.summary.most, value)) break;
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
            if (p.chunk == head_) return std::nullopt;
            --p.chunk;
            if (p.chunk % grouped == grouped - 1 && p.chunk + 1 >= head_ + grouped) {
                const std::size_t begin = p.chunk + 1 - grouped;
                const Summary& group = group_from(begin);
                if (!Search::possible(group.least, group.most, value)) {
                    if (directory_[begin].first <= l) return std::nullopt;
                    p.chunk = begin;
                    continue;
                }
            }
            const Entry& next = directory_[p.chunk];
            if (!next.summary.valid) sum(next);
            if (Search::possible(next.summary.least, next.summary.most, value)) break;
            if (next.first <= l) return std::nullopt;
        }
        p.index = directory_[p.chunk].chunk->end - 1;
    }
}

} // namespace rtamt::early
