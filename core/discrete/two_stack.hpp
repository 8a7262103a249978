// A sliding window over a monoid: the aggregate of the last w elements.
//
// Two stacks in one ring of w cells, the streaming form of van Herk's and of Gil and Werman's
// running-extremum algorithm (M. van Herk, "A fast algorithm for local minimum and maximum filters
// on rectangular and octagonal kernels", 1992; J. Gil, M. Werman, "Computing 2-D min, median, and
// max filters", 1993). Time is cut into stretches of w slots. Cells before `fill` hold the elements
// of this stretch, `back` their total; cells from `fill` on hold, from the stretch before, the
// total from there to its end. The window is always a tail of the one and a head of the other.
//
// Cost: three operations of the monoid a sample whatever w, in runs between the ends of stretches;
// at the end of a stretch, one pass over the ring. Memory: w elements, touched as far as the trace
// has come.
#pragma once

#include "../program/snapshot.hpp"
#include "../values/monoid.hpp"
#include "../values/vectors.hpp"
#include "copy.hpp"
#include "journal.hpp"
#include "kernel.hpp"
#include "undefined.hpp"

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <limits>

namespace rtamt::discrete {

// The operands of a window, of which the second is read by binary monoids only.
template <Monoid M>
struct Operands {
    const typename M::Value* a;
    const typename M::Value* b;

    [[nodiscard]] typename M::Element operator[](std::size_t i) const noexcept {
        if constexpr (M::binary) {
            return M::element(a[i], b[i]);
        } else {
            return M::element(a[i]);
        }
    }
    [[nodiscard]] Operands from(std::size_t i) const noexcept {
        return {a + i, M::binary ? b + i : b};
    }
};

// The loops between the ends of stretches. To be specialised where a monoid allows better ones.
//
// Each sample waits for the one before it, and this latency is what small elements of doubles cost:
// four of them are combined with each other before they meet the total, where the operation is
// associative, so that the results are the same. Other elements cost their instructions.
template <Monoid M>
struct Stretch {
    using Element = typename M::Element;
    using Value = typename M::Value;

    // Replaces every cell by the total from there to the end.
    static void flip(Element* ring, std::size_t width) noexcept {
        Element tail = M::identity;
        std::size_t i = width;
        if constexpr (grouped) {
            for (; i >= 4; i -= 4) {
                Element* cell = ring + (i - 4);
                const Element two = M::prepend(cell[2], cell[3]);
                const Element three = M::prepend(cell[1], two);
                const Element four = M::prepend(cell[0], three);
                cell[3] = M::prepend(cell[3], tail);
                cell[2] = M::prepend(two, tail);
                cell[1] = M::prepend(three, tail);
                tail = M::prepend(four, tail);
                cell[0] = tail;
            }
        }
        for (; i > 0; --i) {
            tail = M::prepend(ring[i - 1], tail);
            ring[i - 1] = tail;
        }
    }

    // In the first stretch of a trace: nothing is before it. Returns the new back.
    [[nodiscard]] static Element grow(Operands<M> in, Element* cells, Element back, Value* out,
                                      std::size_t count) noexcept {
        return each(in, cells, back, count,
                    [=](std::size_t i, const Element& total) { out[i] = M::result(total); });
    }

    // In any later stretch. A cell is read for the slot before the one that overwrites it.
    [[nodiscard]] static Element slide(Operands<M> in, Element* cells, Element back, Value* out,
                                       std::size_t count) noexcept {
        return each(in, cells, back, count, [=](std::size_t i, const Element& total) {
            out[i] = M::result(cells[i + 1], total);
        });
    }

  private:
    static constexpr bool grouped = M::associative && sizeof(Element) <= 2 * sizeof(double) &&
                                    !std::integral<typename M::Value>;

    // Hands over the total at each slot, then stores the slot's element. Returns the last total.
    template <class Take>
    [[nodiscard]] RTAMT_INLINE static Element each(Operands<M> in, Element* cells, Element back,
                                                   std::size_t count, Take&& take) noexcept {
        std::size_t i = 0;
        if constexpr (grouped) {
            for (; i + 4 <= count; i += 4) {
                const Element here[] = {in[i], in[i + 1], in[i + 2], in[i + 3]};
                const Element two = M::append(here[0], here[1]);
                const Element four = M::append(two, M::append(here[2], here[3]));
                const Element second = M::append(back, two);
                take(i, M::append(back, here[0]));
                take(i + 1, second);
                take(i + 2, M::append(second, here[2]));
                back = M::append(back, four);
                take(i + 3, back);
                std::copy_n(here, 4, cells + i);
            }
        }
        for (; i < count; ++i) {
            const Element here = in[i];
            back = M::append(back, here);
            take(i, back);
            cells[i] = here;
        }
        return back;
    }
};

template <Monoid M>
class TwoStack {
  public:
    using Element = typename M::Element;
    using Value = typename M::Value;

    // The ring and the journal hold `width` elements; the journal is only used by checkpoint().
    TwoStack(std::size_t width, Element* ring, Element* journal) noexcept
        : ring_(ring), width_(width), journal_(journal) {
        if constexpr (has_narrow) {
            if (width <= Stretch<M>::Narrow::widest) long_run_ = std::max<std::size_t>(width, 16);
        }
    }

    // The next `count` elements, and the aggregate at each.
    RTAMT_INLINE void push(Operands<M> in, Value* out, std::size_t count) noexcept {
        count == 1 ? push_one(in[0], *out) : push_run(in, out, count);
    }

    // Slots after the last element: the window empties.
    void expire(Value* out, std::size_t count) noexcept {
        for (std::size_t done = 0; done < count;) {
            const std::size_t part = room(count - done);
            drop(out + done, part);
            done += part;
        }
    }

    void reset() noexcept { state_ = {}; }

    // At most the next `count` slots will be taken back.
    void checkpoint(std::size_t count) noexcept {
        (void)room(
            1); // ends a full stretch, which changes how the window is held but not what it is
        saved_ = state_;
        if (count <= width_ - state_.fill) {
            journal_.save(ring_, state_.fill, state_.front ? count : 0);
        } else {
            journal_.save(ring_, 0, state_.front ? width_ : state_.fill);
        }
    }

    void rollback() noexcept {
        state_ = saved_;
        journal_.restore(ring_);
    }

    void transfer(Snapshot& snapshot) {
        snapshot.item(state_.fill);
        snapshot.item(state_.back);
        snapshot.item(state_.front);
        snapshot.require(state_.fill <= width_);
        snapshot.values(ring_, state_.front ? width_ : state_.fill);
    }

  private:
    // Whether a run of at least `long_run_` elements costs less without the stacks.
    static constexpr bool has_narrow = requires { typename Stretch<M>::Narrow; };

    struct State {
        std::size_t fill = 0;
        Element back = M::identity;
        bool front = false; // whether there was a stretch before this one
    };

    Element* ring_;
    std::size_t width_;
    State state_;
    State saved_;
    Journal<Element> journal_;
    std::size_t long_run_ = std::numeric_limits<std::size_t>::max();

    RTAMT_INLINE void push_one(const Element& here, Value& out) noexcept {
        (void)room(1);
        const Element back = M::append(state_.back, here);
        const std::size_t next = state_.fill + 1;
        out = state_.front && next < width_ ? M::result(ring_[next], back) : M::result(back);
        ring_[state_.fill] = here;
        state_.back = back;
        state_.fill = next;
    }

    void push_run(Operands<M> in, Value* out, std::size_t count) noexcept {
        if constexpr (has_narrow) {
            if (count >= long_run_) return push_long_run(in, out, count);
        }
        for (std::size_t done = 0; done < count;) {
            const std::size_t part = room(count - done);
            state_.front ? slide(in.from(done), out + done, part)
                         : grow(in.from(done), out + done, part);
            done += part;
        }
    }

    // The totals that are left of the stretch before stand for the elements that they are made of:
    // a window that contains one of these totals contains all of those elements.
    void push_long_run(Operands<M> in, Value* out, std::size_t count) noexcept {
        typename Stretch<M>::Narrow window(width_);
        Element* before = window.before();
        if (state_.fill == width_) {
            copy_values(ring_ + 1, width_ - 1, before);
        } else {
            const std::size_t older = width_ - state_.fill - 1;
            if (state_.front) {
                copy_values(ring_ + state_.fill + 1, older, before);
            } else {
                fill_values(before, older, M::identity);
            }
            copy_values(ring_, state_.fill, before + older);
        }
        window.run(in.a, out, count);
        copy_values(in.a + (count - width_), width_, ring_);
        state_ = {width_, M::identity, true};
    }

    // How many of `count` slots fit into this stretch, after ending it if it is full.
    [[nodiscard]] std::size_t room(std::size_t count) noexcept {
        if (state_.fill == width_) {
            Stretch<M>::flip(ring_, width_);
            state_ = {0, M::identity, true};
        }
        return std::min(count, width_ - state_.fill);
    }

    void grow(Operands<M> in, Value* out, std::size_t count) noexcept {
        state_.back = Stretch<M>::grow(in, ring_ + state_.fill, state_.back, out, count);
        state_.fill += count;
    }

    void slide(Operands<M> in, Value* out, std::size_t count) noexcept {
        const std::size_t inner = std::min(count, width_ - state_.fill - 1);
        Element* cells = ring_ + state_.fill;
        Element back = Stretch<M>::slide(in, cells, state_.back, out, inner);
        if (inner < count) { // the last slot of the stretch: nothing of the one before is left
            const Element here = in[inner];
            back = M::append(back, here);
            out[inner] = M::result(back);
            cells[inner] = here;
        }
        state_.back = back;
        state_.fill += count;
    }

    void drop(Value* out, std::size_t count) noexcept {
        Element* cells = ring_ + state_.fill;
        const std::size_t inner =
            state_.front ? std::min(count, width_ - state_.fill - 1) : std::size_t{0};
        for (std::size_t i = 0; i < inner; ++i)
            out[i] = M::result(cells[i + 1], state_.back);
        fill_values(out + inner, count - inner, M::result(state_.back));
        fill_values(cells, count, M::identity);
        state_.fill += count;
    }
};

// The kernel of a sliding window, over two stacks or in constant time (steady_window.hpp).
template <Monoid M, class Window = TwoStack<M>>
class Sliding final : public Kernel {
  public:
    using Element = typename M::Element;
    using Value = typename M::Value;

    // `lag`: of the result; it may be less than that of the operand for windows of the past alone.
    Sliding(std::int64_t operand_lag, std::size_t width, Element* ring, Element* journal,
            std::int64_t lag = 0) noexcept
        : Kernel(operand_lag), window_(width, ring, journal), lag_(lag) {}

    std::size_t run(const Block& block) noexcept override {
        const Range present = block.present(lag());
        auto* out = this->out<Value>();
        // Before their first sample the operands leave nothing behind: the window starts with it.
        fill_values(out, present.begin, M::result(M::identity));
        const Operands<M> in{a<Value>(), b<Value>()};
        window_.push(in.from(present.begin), out + present.begin, present.end - present.begin);
        window_.expire(out + present.end, block.count - present.end);
        if constexpr (M::partial) {
            return first_undefined<typename M::Domain>(out, block.until_end(present, lag_));
        }
        return defined;
    }

    void reset() noexcept override { window_.reset(); }
    void checkpoint(std::size_t count) noexcept override { window_.checkpoint(count); }
    void rollback() noexcept override { window_.rollback(); }
    void transfer(Snapshot& snapshot) override { window_.transfer(snapshot); }

  private:
    Window window_;
    std::int64_t lag_;
};

} // namespace rtamt::discrete
