// The times of samples by their index, for samples about one period apart: those that were given,
// and computed ones where there is no sample yet.
//
// Cost: a comparison a sample in order; a late one also looks at those after it, up to the next
// that is kept. Memory: two words for each sample that does not come exactly a whole number of
// periods after the last such sample; none while all others do.
#pragma once

#include "runs.hpp"
#include "state_checks.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

namespace rtamt::early {

class SampleTimes {
  public:
    SampleTimes(double period, double tolerance) : period_(period), tolerance_(tolerance) {}

    // The index of a time, if it is on the grid that the newest sample continues.
    [[nodiscard]] std::optional<Tick> place(double time) const noexcept {
        if (!std::isfinite(time)) return std::nullopt;
        if (newest_ < 0) return first_;
        const double steps = std::round((time - last_) / period_);
        if (std::fabs(steps) > farthest) return std::nullopt;
        if (std::fabs(time - last_ - steps * period_) > tolerance_ * period_) return std::nullopt;
        return newest_ + static_cast<Tick>(steps);
    }

    // The index of the first sample, which has not come yet; 0 otherwise.
    void begin_at(Tick index) noexcept { first_ = index; }

    // The last index whose time is not after this one.
    [[nodiscard]] Tick floor(double time) const noexcept {
        const double steps = std::floor((time - last_) / period_ + tolerance_);
        return newest_ + static_cast<Tick>(std::clamp(steps, -farthest, farthest));
    }

    // A sample newer than all before.
    void add(Tick index, double time) {
        if (anchors_.empty() || at(index) != time) anchors_.push_back({index, time});
        newest_ = index;
        last_ = time;
    }

    // The first sample at an index before the newest one. `next`: from an index to that of the next
    // sample. Later samples keep their times.
    template <class Next>
    void insert(Tick index, double time, Next&& next) {
        if (at(index) == time) return;
        const auto after =
            std::ranges::upper_bound(anchors_, index, {}, [](const Anchor& a) { return a.index; });
        const Tick end = after == anchors_.end() ? newest_ + 1 : after->index;
        std::vector<Anchor> added{{index, time}};
        for (Tick t = next(index); t < end; t = next(t)) {
            const double given = at(t);
            if (continued(added.back(), t) != given) added.push_back({t, given});
        }
        anchors_.insert(after, added.begin(), added.end());
    }

    [[nodiscard]] double at(Tick index) const noexcept {
        const auto after =
            std::ranges::upper_bound(anchors_, index, {}, [](const Anchor& a) { return a.index; });
        const Anchor& anchor = after == anchors_.begin() ? *after : *std::prev(after);
        return continued(anchor, index);
    }

    // Forgets the times of samples before an index, but for those that are computed.
    void drop_before(Tick index) {
        std::size_t drop = 0;
        while (drop + 1 < anchors_.size() && anchors_[drop + 1].index <= index)
            ++drop;
        if (drop > anchors_.size() / 2) {
            anchors_.erase(anchors_.begin(), anchors_.begin() + static_cast<std::ptrdiff_t>(drop));
        }
    }

    // The index of the newest sample, -1 before the first.
    [[nodiscard]] Tick newest() const noexcept { return newest_; }
    [[nodiscard]] double last() const noexcept { return last_; }
    [[nodiscard]] double period() const noexcept { return period_; }
    // The earliest time that is kept.
    [[nodiscard]] double earliest() const noexcept {
        return anchors_.empty() ? last_ : anchors_.front().time;
    }

    [[nodiscard]] std::size_t bytes() const noexcept { return anchors_.size() * sizeof(Anchor); }

    void transfer(Snapshot& snapshot) {
        Tick next = 0;
        checked::list(snapshot, anchors_, sizeof(Anchor), [&](Anchor& anchor) {
            checked::tick(snapshot, anchor.index, next);
            snapshot.item(anchor.time);
            snapshot.require(std::isfinite(anchor.time));
            next = anchor.index + 1;
        });
        checked::tick(snapshot, newest_, -1);
        snapshot.item(last_);
        snapshot.require((newest_ < 0) == anchors_.empty() && next <= newest_ + 1);
        snapshot.require(std::isfinite(last_) && (newest_ < 0 || at(newest_) == last_));
    }

  private:
    struct Anchor {
        Tick index;
        double time;
    };
    static constexpr double farthest = 281'474'976'710'656.0; // 2^48

    std::vector<Anchor> anchors_; // samples that do not continue the one before
    Tick first_ = 0;
    Tick newest_ = -1;
    double last_ = 0.0;
    double period_;
    double tolerance_;

    [[nodiscard]] double continued(const Anchor& anchor, Tick index) const noexcept {
        return anchor.time + static_cast<double>(index - anchor.index) * period_;
    }
};

} // namespace rtamt::early
