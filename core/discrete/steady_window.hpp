// A sliding window over a monoid whose every sample costs the same: no stretch ends with a pass
// over it, as in two_stack.hpp.
//
// Time is cut into stretches of half a window, so that a window is a tail of the last but one, all
// of the last and a head of this one. While a stretch fills, one total a slot is made of the one
// before it, from its end to its start: when the tails of that one are needed, all are there. Any
// window of that length can be had in constant time (M. Hirzel, S. Schneider, K. Tangwongsan,
// "Sliding-window aggregation algorithms: tutorial", 2017); that it is fixed makes this one
// shorter.
//
// Cost: four operations of the monoid a sample and no more, whatever w. Memory: w elements, all of
// them written by the constructor, so that no sample waits for a page.
#pragma once

#include "two_stack.hpp"

#include <cstddef>
#include <cstdint>

namespace rtamt::discrete {

// Narrower ones are no longer in two stacks.
inline constexpr std::int64_t narrowest_steady = 2;

template <Monoid M>
class SteadyWindow {
  public:
    using Element = typename M::Element;
    using Value = typename M::Value;

    // The ring and the journal, if there is one, hold `width` elements.
    SteadyWindow(std::size_t width, Element* ring, Element* journal) noexcept
        : ring_(ring), half_(width / 2), odd_(width % 2 != 0), journal_(journal) {
        fill_values(ring, width, M::identity);
        if (journal != nullptr) fill_values(journal, width, M::identity);
    }

    void push(Operands<M> in, Value* out, std::size_t count) noexcept {
        for (std::size_t i = 0; i < count; ++i)
            out[i] = next(in[i]);
    }

    // Slots after the last element: the window empties.
    void expire(Value* out, std::size_t count) noexcept {
        for (std::size_t i = 0; i < count; ++i)
            out[i] = next(M::identity);
    }

    void reset() noexcept { state_ = {}; }

    // At most the next `count` slots will be taken back.
    void checkpoint(std::size_t count) noexcept {
        saved_ = state_;
        saved_count_ = count;
        if (count <= half_ - state_.fill) {
            copy_values(this_stretch() + state_.fill, count, journal_);
            copy_values(last_stretch() + (half_ - state_.fill - count), count, journal_ + count);
        } else {
            copy_values(ring_, 2 * half_, journal_);
        }
    }

    void rollback() noexcept {
        state_ = saved_;
        if (saved_count_ <= half_ - state_.fill) {
            copy_values(journal_, saved_count_, this_stretch() + state_.fill);
            copy_values(journal_ + saved_count_, saved_count_,
                        last_stretch() + (half_ - state_.fill - saved_count_));
        } else {
            copy_values(journal_, 2 * half_, ring_);
        }
    }

    void transfer(Snapshot& snapshot) {
        snapshot.item(state_.fill);
        snapshot.item(state_.head);
        snapshot.item(state_.middle);
        snapshot.item(state_.tail);
        snapshot.item(state_.stretches);
        snapshot.item(state_.swapped);
        snapshot.require(state_.fill < half_ && state_.stretches <= 2);
        snapshot.values(ring_, 2 * half_);
    }

  private:
    struct State {
        std::size_t fill = 0;         // slots of this stretch so far
        Element head = M::identity;   // total of this stretch so far
        Element middle = M::identity; // total of the last stretch
        Element tail = M::identity;   // total of its last `fill` elements
        std::size_t stretches = 0;    // before this one; two stand for any number
        bool swapped = false;         // whether this stretch is the second half of the ring
    };

    Element* ring_;
    std::size_t half_;
    bool odd_;
    Element* journal_;
    State state_;
    State saved_;
    std::size_t saved_count_ = 0;

    [[nodiscard]] Element* this_stretch() noexcept { return ring_ + (state_.swapped ? half_ : 0); }
    [[nodiscard]] Element* last_stretch() noexcept { return ring_ + (state_.swapped ? 0 : half_); }

    [[nodiscard]] Value next(const Element& here) noexcept {
        Element* cells = this_stretch();
        const std::size_t i = state_.fill;
        // Of the stretch before the last, from the element that the window begins with.
        const std::size_t begin = odd_ ? i : i + 1;
        Element older = state_.middle;
        if (state_.stretches == 2 && begin < half_) older = M::prepend(cells[begin], older);
        state_.head = M::append(state_.head, here);
        cells[i] = here;
        if (state_.stretches != 0) {
            Element& cell = last_stretch()[half_ - 1 - i];
            state_.tail = M::prepend(cell, state_.tail);
            cell = state_.tail;
        }
        const Value result = M::result(older, state_.head);
        if (++state_.fill == half_) {
            state_ = {0,
                      M::identity,
                      state_.head,
                      M::identity,
                      std::min<std::size_t>(state_.stretches + 1, 2),
                      !state_.swapped};
        }
        return result;
    }
};

} // namespace rtamt::discrete
