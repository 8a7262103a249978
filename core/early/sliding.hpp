// The least or the greatest value in windows that slide over values in the order of time.
//
// Cost: amortised constant for each value. Memory: the values that no later one outdoes.
#pragma once

#include "step_map.hpp"

#include <cstddef>
#include <limits>
#include <vector>

namespace rtamt::early {

class Sliding {
  public:
    explicit Sliding(bool greatest) noexcept : greatest_(greatest) {}

    // One value of the ticks behind those of the last one, up to `t`.
    void add(Tick t, double value) {
        while (!empty() && (greatest_ ? kept_.back().value <= value : kept_.back().value >= value))
            kept_.pop_back();
        kept_.push_back({t, value});
    }

    // The extreme value from a tick on, which never decreases; an infinity where there is none.
    [[nodiscard]] double from(Tick t) {
        while (!empty() && kept_[first_].last < t)
            ++first_;
        if (empty()) {
            clear();
            constexpr double infinity = std::numeric_limits<double>::infinity();
            return greatest_ ? -infinity : infinity;
        }
        if (first_ >= many && 2 * first_ > kept_.size()) {
            kept_.erase(kept_.begin(), kept_.begin() + static_cast<std::ptrdiff_t>(first_));
            first_ = 0;
        }
        return kept_[first_].value;
    }

    void clear() noexcept {
        kept_.clear();
        first_ = 0;
    }

    [[nodiscard]] std::size_t bytes() const noexcept { return kept_.capacity() * sizeof(Kept); }

  private:
    struct Kept {
        Tick last;
        double value;
    };
    static constexpr std::size_t many = 32; // values to forget at once

    bool greatest_;
    std::vector<Kept> kept_; // from first_ on
    std::size_t first_ = 0;

    [[nodiscard]] bool empty() const noexcept { return first_ == kept_.size(); }
};

} // namespace rtamt::early
