// The samples of one input on their way into the program, which may be ahead of the other inputs.
//
// Samples of an update are read where the caller has them; only those that are left over at its end
// are copied. Memory: 8 bytes and a value a sample that waits for other inputs.
#pragma once

#include "events.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>

namespace rtamt::dense {

template <class Value>
class InputQueue {
  public:
    using Events = BasicEvents<Value>;

    // The samples of an update, which stay where they are until settle() or restore().
    void attach(const Events& fresh) {
        saved_ = {first_, last_, queue_.count()};
        borrowed_ = head_ == queue_.count();
        if (!borrowed_) queue_.append(fresh);
        rewind_ = rest_ = borrowed_ ? fresh : queue_.view().from(head_);
        if (fresh.count == 0) return;
        if (!first_) first_ = fresh.times[0];
        last_ = fresh.times[fresh.count - 1];
    }

    // The update is done: what was not read waits.
    void settle() {
        view_ = {};
        if (borrowed_) {
            head_ = 0;
            queue_.resize(0);
            if (rest_.count != 0) queue_.append(rest_);
        } else {
            head_ = queue_.count() - rest_.count;
            if (2 * head_ >= queue_.count()) { // amortised O(1) a sample, and half of it in use
                queue_.erase_front(head_);
                head_ = 0;
            }
        }
        rest_ = queue_.view().from(head_);
    }

    // The update never was.
    void restore() noexcept {
        first_ = saved_.first;
        last_ = saved_.last;
        queue_.resize(saved_.queued);
        view_ = {};
        rest_ = queue_.view().from(head_);
    }

    // Back to where the update began, to read it once more.
    void rewind() noexcept { rest_ = rewind_; }

    void reset() noexcept {
        queue_.resize(0);
        head_ = 0;
        rest_ = view_ = {};
        first_.reset();
        last_.reset();
    }

    // Between updates: the samples that wait, and when the first and the last were.
    void transfer(Snapshot& snapshot) {
        queue_.erase_front(head_);
        head_ = 0;
        queue_.transfer(snapshot);
        rest_ = queue_.view();
        snapshot.item(first_);
        snapshot.item(last_);
        snapshot.require(valid());
    }

    // Between updates: when the first sample that waits is.
    [[nodiscard]] std::optional<std::int64_t> next() const noexcept {
        return rest_.count == 0 ? std::nullopt : std::optional(rest_.times[0]);
    }

    // Makes the value at the start of the trace the one event of the view.
    void begin(std::int64_t time) noexcept {
        const std::size_t past = rest_.until(time, rest_.count);
        start_time_ = time;
        start_value_ = rest_.values[past - 1];
        view_ = {&start_time_, &start_value_, 1};
        rest_ = rest_.from(past);
    }

    // When the last of the next `count` samples is, if there are more than these.
    [[nodiscard]] std::int64_t reach(std::size_t count) const noexcept {
        return rest_.count > count ? rest_.times[count - 1] : never;
    }

    // Makes the samples up to this time, at most `limit`, the view.
    void load(std::int64_t time, std::size_t limit) noexcept {
        const std::size_t count = rest_.until(time, limit);
        view_ = {rest_.times, rest_.values, count};
        rest_ = rest_.from(count);
    }

    [[nodiscard]] const Events& view() const noexcept { return view_; }
    [[nodiscard]] std::optional<std::int64_t> first() const noexcept { return first_; }
    [[nodiscard]] std::optional<std::int64_t> last() const noexcept { return last_; }
    [[nodiscard]] std::size_t bytes() const noexcept { return queue_.bytes(); }

  private:
    // Whether the samples that wait are in order, the last one the last of all.
    [[nodiscard]] bool valid() const noexcept {
        if (first_.has_value() != last_.has_value()) return false;
        if (!first_) return rest_.count == 0;
        for (std::size_t i = 1; i < rest_.count; ++i) {
            if (rest_.times[i] <= rest_.times[i - 1]) return false;
        }
        return *first_ <= *last_ && (rest_.count == 0 || (rest_.times[0] >= *first_ &&
                                                          rest_.times[rest_.count - 1] == *last_));
    }

    struct Saved {
        std::optional<std::int64_t> first;
        std::optional<std::int64_t> last;
        std::size_t queued = 0;
    };

    BasicEventList<Value> queue_; // what earlier updates left over
    std::size_t head_ = 0;        // of which so many have been read since
    Events rest_;                 // what is to be read
    Events rewind_;               // and what was, when the update began
    Events view_;                 // what the program reads now
    std::int64_t start_time_ = 0;
    Value start_value_{};
    std::optional<std::int64_t> first_; // time of the first sample
    std::optional<std::int64_t> last_;  // and of the last one
    Saved saved_;
    bool borrowed_ = false; // rest_ is the caller's memory
};

} // namespace rtamt::dense
