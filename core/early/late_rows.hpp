// What is known of all inputs at the ticks of samples that others may still join or make more
// precise, in discrete time.
//
// Cost: constant near the newest tick, else a search; a row that comes before others moves these.
// Memory: a tick and bounds of every input for each row.
#pragma once

#include "../values/bounds.hpp"
#include "state_checks.hpp"
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

    [[nodiscard]] bool contains(Tick t) const noexcept { return is_at(find(t), t); }

    [[nodiscard]] std::span<const Bounds> at(Tick t) const noexcept {
        const std::size_t place = find(t);
        return is_at(place, t) ? row(place) : ranges_;
    }

    // The tick of the next row after a tick, `forever` where there is none.
    [[nodiscard]] Tick after(Tick t) const noexcept {
        const std::size_t place = find(t + 1);
        return place < ticks_.size() ? ticks_[place] : forever;
    }

    void set(Tick t, std::span<const Bounds> values) {
        const std::size_t place = find(t);
        if (is_at(place, t)) {
            std::ranges::copy(values, rows_.begin() + first_of(place));
            return;
        }
        rows_.reserve(rows_.size() + values.size());
        ticks_.insert(ticks_.begin() + static_cast<std::ptrdiff_t>(place), t);
        rows_.insert(rows_.begin() + first_of(place), values.begin(), values.end());
        sought_ = {t, place};
    }

    // Forgets the rows before a tick; their memory once they are as many as the others.
    void drop_before(Tick t) {
        head_ = find(t);
        sought_ = {};
        if (2 * head_ < ticks_.size()) return;
        rows_.erase(rows_.begin(), rows_.begin() + first_of(head_));
        ticks_.erase(ticks_.begin(), ticks_.begin() + static_cast<std::ptrdiff_t>(head_));
        head_ = 0;
    }

    [[nodiscard]] std::size_t bytes() const noexcept {
        return (ticks_.size() - head_) * (sizeof(Tick) + ranges_.size() * sizeof(Bounds));
    }

    void transfer(Snapshot& snapshot) {
        std::size_t size = ticks_.size() - head_;
        snapshot.count(size, sizeof(Tick) + ranges_.size() * sizeof(Bounds));
        if (snapshot.loading()) {
            head_ = 0;
            sought_ = {};
        }
        ticks_.resize(head_ + size);
        rows_.resize(ticks_.size() * ranges_.size());
        Tick next = 0;
        for (std::size_t i = head_; i < ticks_.size(); ++i) {
            checked::tick(snapshot, ticks_[i], next);
            next = ticks_[i] + 1;
        }
        snapshot.values(rows_.data() + first_of(head_), size * ranges_.size());
        for (std::size_t i = head_ * ranges_.size(); i < rows_.size(); ++i)
            snapshot.require(rows_[i].lower <= rows_[i].upper);
    }

  private:
    std::vector<Bounds> ranges_;
    std::vector<Tick> ticks_; // in order
    std::vector<Bounds> rows_;
    std::size_t head_ = 0; // rows before it are forgotten
    struct Sought {
        Tick tick = -forever; // none
        std::size_t place = 0;
    };
    mutable Sought sought_; // the last result of find()

    [[nodiscard]] bool is_at(std::size_t place, Tick t) const noexcept {
        return place < ticks_.size() && ticks_[place] == t;
    }

    [[nodiscard]] std::ptrdiff_t first_of(std::size_t place) const noexcept {
        return static_cast<std::ptrdiff_t>(place * ranges_.size());
    }

    // The place of the first row at a tick or later.
    [[nodiscard]] std::size_t find(Tick t) const noexcept {
        if (sought_.tick != t) sought_ = {t, search(t)};
        return sought_.place;
    }

    [[nodiscard]] std::size_t search(Tick t) const noexcept {
        constexpr std::size_t near = 16;
        const std::size_t size = ticks_.size();
        if (head_ == size || ticks_.back() < t) return size;
        if (size - head_ >= near && ticks_.back() - t < static_cast<Tick>(near)) {
            std::size_t later = 0;
            for (std::size_t i = 1; i <= near; ++i) // without branches, which are unpredictable
                later += ticks_[size - i] >= t ? 1U : 0U;
            return size - later;
        }
        const auto head = ticks_.begin() + static_cast<std::ptrdiff_t>(head_);
        return static_cast<std::size_t>(std::lower_bound(head, ticks_.end(), t) - ticks_.begin());
    }

    [[nodiscard]] std::span<const Bounds> row(std::size_t place) const noexcept {
        return std::span(rows_).subspan(place * ranges_.size(), ranges_.size());
    }
};

} // namespace rtamt::early
