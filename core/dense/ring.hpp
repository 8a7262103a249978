// The elements of a kernel's window, oldest first, with rollback of an update.
//
// Memory: twice the cells of the longest window so far, those of one update included; an emptied
// ring is reused. After checkpoint(), cells that leave at the front stay where they are until the
// next one, and a cell that is about to be overwritten is kept in a journal, so that rollback()
// restores everything.
// Cost: O(1) a cell that enters, amortised; unlike a copy of the window, it does not grow with it.
#pragma once

#include "../program/snapshot.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace rtamt::dense {

template <class Cell>
class Ring {
  public:
    [[nodiscard]] std::size_t size() const noexcept { return tail_ - head_; }
    [[nodiscard]] bool empty() const noexcept { return tail_ == head_; }
    [[nodiscard]] const Cell& operator[](std::size_t i) const noexcept { return cell(head_ + i); }
    [[nodiscard]] const Cell& front() const noexcept { return cell(head_); }
    [[nodiscard]] const Cell& back() const noexcept { return cell(tail_ - 1); }

    void push_back(const Cell& value) {
        if (tail_ - (pinned_ ? saved_head_ : head_) == capacity_) grow();
        expose(tail_);
        cell(tail_++) = value;
    }
    void pop_front() noexcept { ++head_; }
    void pop_back() noexcept { --tail_; }

    [[nodiscard]] Cell& edit_back() { return edit(size() - 1); }

    // A cell to be changed in place.
    [[nodiscard]] Cell& edit(std::size_t i) {
        expose(head_ + i);
        return cell(head_ + i);
    }

    // The same cells while no update is to be rolled back: with room for those that enter, so that
    // a loop can keep all of it in registers.
    class Loose {
      public:
        [[nodiscard]] std::size_t size() const noexcept { return tail_ - head_; }
        [[nodiscard]] bool empty() const noexcept { return tail_ == head_; }
        [[nodiscard]] const Cell& front() const noexcept { return cells_[head_ & mask_]; }
        [[nodiscard]] const Cell& back() const noexcept { return cells_[(tail_ - 1) & mask_]; }
        [[nodiscard]] Cell& edit_back() noexcept { return cells_[(tail_ - 1) & mask_]; }
        void push_back(const Cell& value) noexcept { cells_[tail_++ & mask_] = value; }
        void pop_front() noexcept { ++head_; }
        void pop_back() noexcept { --tail_; }

      private:
        friend Ring;
        Cell* cells_;
        std::size_t mask_;
        std::size_t head_;
        std::size_t tail_;
        Loose(Cell* cells, std::size_t mask, std::size_t head, std::size_t tail) noexcept
            : cells_(cells), mask_(mask), head_(head), tail_(tail) {}
    };

    [[nodiscard]] bool pinned() const noexcept { return pinned_; }

    // For at most so many calls of push_back(); not between checkpoint() and rollback().
    [[nodiscard]] Loose loosen(std::size_t entering) {
        while (capacity_ - size() < entering)
            grow();
        return {cells_.get(), capacity_ - 1, head_, tail_};
    }
    void fasten(const Loose& loose) noexcept {
        head_ = loose.head_;
        tail_ = loose.tail_;
    }

    void clear() noexcept {
        head_ = tail_ = 0;
        release();
    }

    void checkpoint() noexcept {
        pinned_ = true;
        saved_head_ = head_;
        saved_tail_ = intact_ = tail_;
        journal_.clear();
    }
    void rollback() noexcept {
        for (std::size_t i = intact_; !journal_.empty(); ++i) {
            cell(i) = journal_.back();
            journal_.pop_back();
        }
        head_ = saved_head_;
        tail_ = saved_tail_;
        release();
    }

    // The cells, oldest first; not between checkpoint() and rollback().
    void transfer(Snapshot& snapshot) {
        std::size_t count = size();
        snapshot.count(count, sizeof(Cell));
        if (snapshot.loading()) clear();
        for (std::size_t i = 0; i < count; ++i) {
            Cell cell{};
            if (!snapshot.loading()) cell = (*this)[i];
            snapshot.item(cell);
            if (snapshot.loading()) push_back(cell);
        }
    }

    // Whether the time of the cells, a member of them, increases from after `begin` up to `end`.
    template <class Time>
    [[nodiscard]] bool increasing(std::int64_t begin, std::int64_t end,
                                  Time&& time) const noexcept {
        std::int64_t last = begin;
        for (std::size_t i = 0; i < size(); ++i) {
            const std::int64_t now = std::invoke(time, (*this)[i]);
            if (now <= last) return false;
            last = now;
        }
        return empty() || last <= end;
    }

    // How many cells from the front on satisfy a condition that, once false, stays so. Cost: the
    // logarithm of the result.
    template <class Condition>
    [[nodiscard]] std::size_t count_while(Condition&& condition) const noexcept {
        std::size_t low = 0; // the number that do
        std::size_t step = 1;
        while (low + step <= size() && condition(low + step - 1)) {
            low += step;
            step *= 2;
        }
        std::size_t high = std::min(low + step - 1, size()); // at most so many do
        while (low < high) {
            const std::size_t middle = low + (high - low) / 2;
            if (condition(middle)) {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        return low;
    }

    [[nodiscard]] std::size_t bytes() const noexcept {
        return (capacity_ + journal_.capacity()) * sizeof(Cell);
    }

  private:
    std::unique_ptr<Cell[]> cells_;
    std::size_t capacity_ = 0; // a power of two
    // Places are counted from the first cell ever, and fall into the ring modulo its capacity.
    std::size_t head_ = 0;
    std::size_t tail_ = 0;
    std::size_t saved_head_ = 0;
    std::size_t saved_tail_ = 0;
    std::size_t intact_ = 0;    // since the checkpoint, nothing before this place was overwritten
    bool pinned_ = false;       // what was there at the checkpoint is kept
    std::vector<Cell> journal_; // the cells from intact_ to saved_tail_, last first

    [[nodiscard]] Cell& cell(std::size_t place) noexcept { return cells_[place & (capacity_ - 1)]; }
    [[nodiscard]] const Cell& cell(std::size_t place) const noexcept {
        return cells_[place & (capacity_ - 1)];
    }

    void release() noexcept {
        pinned_ = false;
        intact_ = 0;
    }

    // Keeps what is at this place and after, which is about to be overwritten.
    void expose(std::size_t place) {
        while (place < intact_) {
            journal_.push_back(cell(intact_ - 1));
            --intact_;
        }
    }

    void grow() {
        const std::size_t capacity = std::max<std::size_t>(2 * capacity_, 8);
        auto cells = std::make_unique_for_overwrite<Cell[]>(capacity);
        const std::size_t end = std::max(tail_, intact_);
        for (std::size_t place = pinned_ ? saved_head_ : head_; place < end; ++place) {
            cells[place & (capacity - 1)] = cell(place);
        }
        cells_ = std::move(cells);
        capacity_ = capacity;
    }
};

} // namespace rtamt::dense
