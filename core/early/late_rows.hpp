// What is known of all inputs at the ticks of samples that others may still join or make more
// precise, in discrete time.
//
// Cost: constant at the newest ticks where none is missing, else a search; a row that comes before
// others moves these. Memory: a tick and bounds of every input for each row.
#pragma once

#include "../program/snapshot.hpp"
#include "../values/bounds.hpp"
#include "step_map.hpp"

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace rtamt::early {

class LateRows {
  public:
    // `ranges`: what is known of each input before it is seen.
    explicit LateRows(std::vector<Bounds> ranges) : ranges_(std::move(ranges)) {}

    [[nodiscard]] std::span<const Bounds> at(Tick t) const noexcept {
        const std::size_t place = find(t);
        return place < ticks_.size() && ticks_[place] == t ? row(place) : ranges_;
    }

    void set(Tick t, std::span<const Bounds> values) {
        const std::size_t place = find(t);
        const std::size_t width = ranges_.size();
        if (place == ticks_.size() || ticks_[place] != t) {
            rows_.reserve(rows_.size() + width);
            ticks_.insert(ticks_.begin() + static_cast<std::ptrdiff_t>(place), t);
            rows_.insert(rows_.begin() + static_cast<std::ptrdiff_t>(place * width), values.begin(),
                         values.end());
        } else {
            std::ranges::copy(values, rows_.begin() + static_cast<std::ptrdiff_t>(place * width));
        }
    }

    // Forgets the rows before a tick.
    void drop_before(Tick t) {
        const std::size_t place = find(t);
        const auto count = static_cast<std::ptrdiff_t>(place);
        ticks_.erase(ticks_.begin(), ticks_.begin() + count);
        rows_.erase(rows_.begin(),
                    rows_.begin() + count * static_cast<std::ptrdiff_t>(ranges_.size()));
    }

    [[nodiscard]] std::size_t bytes() const noexcept {
        return ticks_.size() * sizeof(Tick) + rows_.size() * sizeof(Bounds);
    }

    void transfer(Snapshot& snapshot) {
        std::size_t size = ticks_.size();
        snapshot.count(size, sizeof(Tick) + ranges_.size() * sizeof(Bounds));
        ticks_.resize(size);
        rows_.resize(size * ranges_.size());
        snapshot.values(ticks_.data(), ticks_.size());
        snapshot.values(rows_.data(), rows_.size());
        for (std::size_t i = 1; i < size; ++i)
            snapshot.require(ticks_[i - 1] < ticks_[i]);
        for (const Bounds& each : rows_)
            snapshot.require(each.lower <= each.upper);
    }

  private:
    std::vector<Bounds> ranges_;
    std::vector<Tick> ticks_; // in order
    std::vector<Bounds> rows_;

    // The place of the first row at a tick or later.
    [[nodiscard]] std::size_t find(Tick t) const noexcept {
        const std::size_t size = ticks_.size();
        if (size == 0 || ticks_.back() < t) return size;
        // As far from the end, if none is missing.
        const auto back = static_cast<std::size_t>(ticks_.back() - t);
        if (back < size) {
            const std::size_t place = size - 1 - back;
            if (ticks_[place] == t) return place;
        }
        return static_cast<std::size_t>(std::ranges::lower_bound(ticks_, t) - ticks_.begin());
    }

    [[nodiscard]] std::span<const Bounds> row(std::size_t place) const noexcept {
        return std::span(rows_).subspan(place * ranges_.size(), ranges_.size());
    }
};

} // namespace rtamt::early
