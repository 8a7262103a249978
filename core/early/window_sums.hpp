// Sums of bounds over windows of one width, of those that end at consecutive ticks.
//
// Doubles round, so that their order matters. Ticks are cut into blocks as long as the window, from
// tick 0 on: a window is the end of one block, added backwards, and the begin of the next, added
// forwards, as in discrete/two_stack.hpp. A window of the same bounds at every tick that may be
// anywhere has the hull of its sums at all places.
//
// Cost: two additions a window, and as many as it is wide when a block begins or what was added
// changes. Memory: bounds for each tick of a window.
#pragma once

#include "../values/algebra.hpp"
#include "../values/interval.hpp"
#include "runs.hpp"

#include <cmath>
#include <cstddef>
#include <vector>

namespace rtamt::early {

class WindowSums {
  public:
    using Add = SumOf<Interval>;

    explicit WindowSums(Tick width) noexcept : width_(width) {}

    // Bounds at [l, r] have changed, or any.
    void change(Tick l, Tick r) noexcept {
        if (l < next_ && r >= block_ - width_) forget();
    }
    void forget() noexcept { block_ = none; }

    // The sum over the window that ends at a tick; `read(t)` are the bounds at a tick.
    template <class Read>
    [[nodiscard]] Bounds at(Tick end, Read&& read) {
        const Tick block = end / width_ * width_;
        if (block != block_) {
            ending_.clear();
            block_ = block;
            next_ = forever;
        }
        if (end + 1 < next_) {
            beginning_ = Add::identity;
            next_ = block;
        }
        for (; next_ <= end; ++next_)
            beginning_ = Add::join(read(next_), beginning_);
        const auto before = static_cast<std::size_t>(block == 0 ? 0 : block - (end - width_ + 1));
        while (ending_.size() < before) {
            const Bounds& rest = ending_.empty() ? Add::identity : ending_.back();
            ending_.push_back(Add::join(read(block - 1 - static_cast<Tick>(ending_.size())), rest));
        }
        return before == 0 ? beginning_ : Add::join(ending_[before - 1], beginning_);
    }

    // The sum where the bounds of every tick of the window are the same.
    [[nodiscard]] Bounds anywhere(const Bounds& each) {
        if (each == each_) return hull_;
        each_ = each;
        hull_ = width_ <= longest ? hull(each) : Bounds{-slack(-each.lower), slack(each.upper)};
        return hull_;
    }

  private:
    static constexpr Tick none = -1;
    static constexpr Tick longest = 65'536; // of which every place is tried

    Tick width_;
    Tick block_ = none;          // where the block begins in which the last window ended
    std::vector<Bounds> ending_; // sums of the last ticks before it
    Bounds beginning_ = Add::identity;
    Tick next_ = 0; // the first tick that is not added to it
    Bounds each_ = bounds::nothing;
    Bounds hull_ = bounds::nothing;

    [[nodiscard]] Bounds hull(const Bounds& each) const {
        std::vector<Bounds> sums{Add::identity};
        for (Tick i = 0; i < width_; ++i)
            sums.push_back(Add::join(each, sums.back()));
        Bounds hull = sums.back();
        for (std::size_t i = 1; i + 1 < sums.size(); ++i) {
            const Bounds sum = Add::join(sums[i], sums[sums.size() - 1 - i]);
            hull = {Real::meet(hull.lower, sum.lower), Real::join(hull.upper, sum.upper)};
        }
        return hull;
    }

    // No less than any sum of as many numbers, each of which is rounded.
    [[nodiscard]] double slack(double each) const noexcept {
        const auto count = static_cast<double>(width_);
        return each * count + std::fabs(each * count) * count * 0x1p-52;
    }
};

} // namespace rtamt::early
