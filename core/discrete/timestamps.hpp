// The times of the last few samples: late values are reported with the time they belong to.
//
// Cost: a multiplication a sample. Memory: none while every sample comes exactly a period after the
// one before, which is computed instead; from the first that does not, a ring of as many numbers as
// were requested, touched as far as the trace has come.
#pragma once

#include "../program/snapshot.hpp"
#include "arena.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>

namespace rtamt::discrete {

class Timestamps {
  public:
    // Keeps the last `size` times, at least one.
    Timestamps(double period, std::size_t size)
        : arena_(size * sizeof(double)),
          ring_(static_cast<double*>(arena_.take(size * sizeof(double)))), size_(size),
          period_(period) {}

    void add(double time) noexcept {
        if (count_ == 0) origin_ = time;
        last_ = time;
        if (regular() && time == computed(count_)) {
            ++regular_;
        } else {
            ring_[next_] = time;
            if (++next_ == size_) next_ = 0;
        }
        ++count_;
    }

    void reset() noexcept {
        last_ = 0.0;
        count_ = 0;
        regular_ = 0;
        next_ = 0;
    }

    void transfer(Snapshot& snapshot) {
        snapshot.item(next_);
        snapshot.item(count_);
        snapshot.item(regular_);
        snapshot.item(origin_);
        snapshot.item(last_);
        snapshot.require(regular_ <= count_ && next_ == (count_ - regular_) % size_);
        snapshot.values(ring_, std::min(count_ - regular_, size_));
    }

    [[nodiscard]] std::size_t count() const noexcept { return count_; }

    // Whether every time so far is the first one and a whole number of periods.
    [[nodiscard]] bool regular() const noexcept { return regular_ == count_; }

    // What keeps them so: the time of a sample by its index, in a trace that begins at 0 if it has
    // not begun.
    [[nodiscard]] double regular_at(std::size_t index) const noexcept {
        return count_ == 0 ? static_cast<double>(index) * period_ : computed(index);
    }

    // The time of a sample that is still here.
    [[nodiscard]] double at(std::size_t index) const noexcept {
        return index < regular_ ? computed(index) : ring_[(index - regular_) % size_];
    }

    // The last time; nothing before the first.
    [[nodiscard]] std::optional<double> last() const noexcept {
        return count_ == 0 ? std::nullopt : std::optional(last_);
    }

    // How many of the last times are still here.
    [[nodiscard]] std::size_t available() const noexcept { return std::min(count_, size_); }

    // Writes the last `count` times, oldest first; that many are available.
    void copy(std::size_t count, double* out) const noexcept {
        const std::size_t stored = std::min(count, count_ - regular_);
        for (std::size_t i = 0; i < count - stored; ++i)
            out[i] = computed(count_ - count + i);
        out += count - stored;
        const std::size_t wrapped = stored > next_ ? stored - next_ : 0;
        std::copy_n(ring_ + (size_ - wrapped), wrapped, out);
        std::copy_n(ring_ + (next_ + wrapped - stored), stored - wrapped, out + wrapped);
    }

    // Bytes in use.
    [[nodiscard]] std::size_t bytes() const noexcept { return regular() ? 0 : arena_.bytes(); }

  private:
    Arena arena_;
    double* ring_; // the times from the first irregular one on
    std::size_t size_;
    std::size_t next_ = 0;    // cell of the ring to be written next
    std::size_t count_ = 0;   // times so far
    std::size_t regular_ = 0; // times before the first irregular one
    double period_;
    double origin_ = 0.0; // the first time
    double last_ = 0.0;

    [[nodiscard]] double computed(std::size_t index) const noexcept {
        return origin_ + static_cast<double>(index) * period_;
    }
};

} // namespace rtamt::discrete
