// The ticks of rows that have come, but have not changed any bounds yet: nobody has read these.
//
// Cost: constant near the newest tick; a row that comes before others moves these. Memory: a tick
// for each row, and one row.
#pragma once

#include "../values/bounds.hpp"
#include "step_map.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace rtamt::early {

class Postponed {
  public:
    // The row of a tick has come; `known`: what was known there before it.
    void add(Tick t, std::span<const Bounds> known) {
        std::size_t place = ticks_.size();
        while (place > head_ && ticks_[place - 1] > t)
            --place;
        joins_ = place > head_ && ticks_[place - 1] == t;
        if (joins_) {
            before_.assign(known.begin(), known.end());
        } else {
            ticks_.insert(ticks_.begin() + static_cast<std::ptrdiff_t>(place), t);
        }
        newest_ = t;
    }

    [[nodiscard]] bool empty() const noexcept { return head_ == ticks_.size(); }
    // The first tick, `forever` if there is none.
    [[nodiscard]] Tick front() const noexcept { return empty() ? forever : ticks_[head_]; }
    void pop() noexcept {
        if (2 * ++head_ < ticks_.size()) return;
        ticks_.erase(ticks_.begin(), ticks_.begin() + static_cast<std::ptrdiff_t>(head_));
        head_ = 0;
    }

    // The tick of the last row that came.
    [[nodiscard]] Tick newest() const noexcept { return newest_; }
    // Whether others of its tick came before it, and what was known there from them.
    [[nodiscard]] bool joins() const noexcept { return joins_; }
    [[nodiscard]] std::span<const Bounds> before() const noexcept { return before_; }

    void clear() noexcept {
        ticks_.clear();
        head_ = 0;
    }

    [[nodiscard]] std::size_t bytes() const noexcept {
        return (ticks_.size() - head_) * sizeof(Tick);
    }

  private:
    std::vector<Tick> ticks_; // in order
    std::size_t head_ = 0;    // those before it are dropped
    Tick newest_ = -1;
    bool joins_ = false;
    std::vector<Bounds> before_;
};

} // namespace rtamt::early
