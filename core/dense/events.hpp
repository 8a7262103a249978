// Step functions as events: from each time on its value holds, until the next event, and
// the last value for ever. Times are ticks from -(2^63 - 1) on and increase strictly.
//
// Memory: 8 bytes and a value an event. A list grows to twice its size, by realloc, which moves
// large lists without copying them, and keeps its memory when cleared.
#pragma once

#include "../program/snapshot.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <memory>
#include <new>

namespace rtamt::dense {

// Later than every event: what lies beyond the range of ticks does not happen.
inline constexpr std::int64_t never = std::numeric_limits<std::int64_t>::max();

// A time that is `distance` >= 0 later, or never.
[[nodiscard]] constexpr std::int64_t later(std::int64_t time, std::int64_t distance) noexcept {
    return time > never - distance ? never : time + distance;
}

// Events owned by others.
template <class Value>
struct BasicEvents {
    const std::int64_t* times = nullptr;
    const Value* values = nullptr;
    std::size_t count = 0;

    // Without the first `skipped` events.
    [[nodiscard]] BasicEvents from(std::size_t skipped) const noexcept {
        return {times + skipped, values + skipped, count - skipped};
    }

    // How many of the first `limit` events are at this time or before.
    [[nodiscard]] std::size_t until(std::int64_t time, std::size_t limit) const noexcept {
        const std::size_t size = std::min(count, limit);
        if (size == 0 || times[size - 1] <= time) return size;
        return static_cast<std::size_t>(std::upper_bound(times, times + size, time) - times);
    }
};

template <class Value>
class BasicEventList {
  public:
    void append(std::int64_t time, const Value& value) {
        if (count_ == capacity_) grow(count_ + 1);
        times_[count_] = time;
        values_[count_] = value;
        ++count_;
    }

    void append(const BasicEvents<Value>& events) {
        if (events.count > capacity_ - count_) grow(count_ + events.count);
        std::copy_n(events.times, events.count, times_.get() + count_);
        std::copy_n(events.values, events.count, values_.get() + count_);
        count_ += events.count;
    }

    // Room for `count` events, whatever was here before.
    void make_room(std::size_t count) {
        count_ = 0;
        if (count > capacity_) grow(count);
    }

    // The first `count` events only; those that were written beyond the end included.
    void resize(std::size_t count) noexcept { count_ = count; }

    void erase_front(std::size_t skipped) noexcept {
        std::copy(times_.get() + skipped, times_.get() + count_, times_.get());
        std::copy(values_.get() + skipped, values_.get() + count_, values_.get());
        count_ -= skipped;
    }

    void transfer(Snapshot& snapshot) {
        std::size_t count = count_;
        snapshot.count(count, sizeof(std::int64_t) + sizeof(Value));
        if (snapshot.loading()) {
            make_room(count);
            resize(count);
        }
        snapshot.values(times_.get(), count);
        snapshot.values(values_.get(), count);
    }

    [[nodiscard]] std::size_t count() const noexcept { return count_; }
    [[nodiscard]] std::int64_t* times() noexcept { return times_.get(); }
    [[nodiscard]] Value* values() noexcept { return values_.get(); }
    [[nodiscard]] BasicEvents<Value> view() const noexcept {
        return {times_.get(), values_.get(), count_};
    }
    [[nodiscard]] std::size_t bytes() const noexcept {
        return capacity_ * (sizeof(std::int64_t) + sizeof(Value));
    }

  private:
    struct Free {
        void operator()(void* memory) const noexcept {
            std::free(memory); // NOLINT(*-no-malloc): goes with realloc
        }
    };
    template <class Item>
    using Memory = std::unique_ptr<Item[], Free>;

    Memory<std::int64_t> times_;
    Memory<Value> values_;
    std::size_t count_ = 0;
    std::size_t capacity_ = 0;

    template <class Item>
    static void resize(Memory<Item>& memory, std::size_t count) {
        if (count > std::numeric_limits<std::ptrdiff_t>::max() / sizeof(Item)) {
            throw std::bad_alloc();
        }
        // NOLINTNEXTLINE(*-no-malloc): operator new has no way to grow
        void* larger = std::realloc(memory.get(), count * sizeof(Item));
        if (larger == nullptr) throw std::bad_alloc();
        (void)memory.release();
        memory.reset(static_cast<Item*>(larger));
    }

    void grow(std::size_t needed) {
        const std::size_t capacity = std::max({needed, 2 * capacity_, std::size_t{8}});
        resize(times_, capacity);
        resize(values_, capacity);
        capacity_ = capacity;
    }
};

// Of real numbers, as traces and their robustness are.
using Events = BasicEvents<double>;
using EventList = BasicEventList<double>;

} // namespace rtamt::dense
