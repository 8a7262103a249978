// Extremum over the last w slots: bounded once, historically, eventually, always.
//
// Two stacks in one ring of w cells, the streaming form of van Herk's and of Gil and Werman's
// running-extremum algorithm (M. van Herk, "A fast algorithm for local minimum and maximum filters
// on rectangular and octagonal kernels", 1992; J. Gil, M. Werman, "Computing 2-D min, median, and
// max filters", 1993). Time is cut into stretches of w slots. Cells before `fill` hold the values
// of this stretch, `back` their extremum; cells from `fill` on hold, from the stretch before, the
// extremum from there to its end. The window is always a tail of the one and a head of the other.
//
// Cost: three comparisons a sample whatever w, in runs between the ends of stretches; at the end
// of a stretch, one pass over the ring. Memory: w doubles, touched as far as the trace has come.
#pragma once

#include "../cells.hpp"
#include "../journal.hpp"
#include "../kernel.hpp"

namespace rtamt::discrete {

template <class Algebra>
class Slide final : public Kernel {
  public:
    Slide(std::int64_t operand_lag, std::size_t width, double* ring, double* journal) noexcept
        : Kernel(operand_lag), ring_(ring), width_(width), journal_(journal) {}

    std::size_t run(const Block& block) noexcept override {
        const Range present = block.present(lag());
        // Before its first sample the operand leaves nothing behind: the ring starts with it.
        fill_cells(out(), present.begin, Algebra::identity);
        for (std::size_t i = present.begin; i < present.end;) {
            const std::size_t count = room(present.end - i);
            state_.front ? slide(a() + i, out() + i, count) : grow(a() + i, out() + i, count);
            i += count;
        }
        for (std::size_t i = present.end; i < block.count;) {
            const std::size_t count = room(block.count - i);
            expire(out() + i, count);
            i += count;
        }
        return defined;
    }

    void reset() noexcept override { state_ = {}; }

    void checkpoint(std::size_t count) noexcept override {
        (void)room(
            1); // ends a full stretch, which changes how the window is held but not what it is
        saved_ = state_;
        if (count <= width_ - state_.fill) {
            journal_.save(ring_, state_.fill, state_.front ? count : 0);
        } else {
            journal_.save(ring_, 0, state_.front ? width_ : state_.fill);
        }
    }

    void rollback() noexcept override {
        state_ = saved_;
        journal_.restore(ring_);
    }

    void transfer(Snapshot& snapshot) override {
        snapshot.item(state_.fill);
        snapshot.item(state_.back);
        snapshot.item(state_.front);
        snapshot.require(state_.fill <= width_);
        snapshot.cells(ring_, state_.front ? width_ : state_.fill);
    }

  private:
    struct State {
        std::size_t fill = 0;
        double back = Algebra::identity;
        bool front = false; // whether there was a stretch before this one
    };

    double* ring_;
    std::size_t width_;
    State state_;
    State saved_;
    Journal journal_;

    // How many of `count` slots fit into this stretch, after ending it if it is full.
    [[nodiscard]] std::size_t room(std::size_t count) noexcept {
        if (state_.fill == width_) flip();
        return std::min(count, width_ - state_.fill);
    }

    // Replaces every cell by the extremum from there to the end; four at a time, because a chain of
    // dependent comparisons is what would take the time.
    void flip() noexcept {
        double tail = Algebra::identity;
        std::size_t i = width_;
        for (; i >= 4; i -= 4) {
            double* cell = ring_ + (i - 4);
            const double last = Algebra::join(cell[2], cell[3]);
            const double three = Algebra::join(cell[1], last);
            // Not of cell[0] with cell[1] first: the same comparisons twice become branches.
            const double four = Algebra::join(cell[0], three);
            cell[3] = Algebra::join(cell[3], tail);
            cell[2] = Algebra::join(last, tail);
            cell[1] = Algebra::join(three, tail);
            tail = Algebra::join(four, tail);
            cell[0] = tail;
        }
        for (; i > 0; --i) {
            tail = Algebra::join(ring_[i - 1], tail);
            ring_[i - 1] = tail;
        }
        state_ = {0, Algebra::identity, true};
    }

    // The first stretch of a trace: nothing before it.
    void grow(const double* in, double* out, std::size_t count) noexcept {
        double back = state_.back;
        double* cells = ring_ + state_.fill;
        copy_cells(in, count, cells);
        std::size_t i = 0;
        for (; i + 4 <= count; i += 4) {
            const double first = Algebra::join(in[i], in[i + 1]);
            const double last = Algebra::join(in[i + 2], in[i + 3]);
            out[i] = Algebra::join(in[i], back);
            out[i + 1] = Algebra::join(first, back);
            out[i + 2] = Algebra::join(in[i + 2], out[i + 1]);
            back = Algebra::join(Algebra::join(first, last), back);
            out[i + 3] = back;
        }
        for (; i < count; ++i) {
            back = Algebra::join(in[i], back);
            out[i] = back;
        }
        state_.back = back;
        state_.fill += count;
    }

    // Any later stretch. A cell is read for the slot before the one that overwrites it.
    void slide(const double* in, double* out, std::size_t count) noexcept {
        double back = state_.back;
        double* cells = ring_ + state_.fill;
        const std::size_t inner = std::min(count, width_ - state_.fill - 1);
        std::size_t i = 0;
        for (; i + 4 <= inner; i += 4) {
            const double first = Algebra::join(in[i], in[i + 1]);
            const double last = Algebra::join(in[i + 2], in[i + 3]);
            const double back0 = Algebra::join(in[i], back);
            const double back1 = Algebra::join(first, back);
            const double back2 = Algebra::join(in[i + 2], back1);
            back = Algebra::join(Algebra::join(first, last), back);
            out[i] = Algebra::join(back0, cells[i + 1]);
            out[i + 1] = Algebra::join(back1, cells[i + 2]);
            out[i + 2] = Algebra::join(back2, cells[i + 3]);
            out[i + 3] = Algebra::join(back, cells[i + 4]);
            cells[i] = in[i];
            cells[i + 1] = in[i + 1];
            cells[i + 2] = in[i + 2];
            cells[i + 3] = in[i + 3];
        }
        for (; i < inner; ++i) {
            back = Algebra::join(in[i], back);
            out[i] = Algebra::join(back, cells[i + 1]);
            cells[i] = in[i];
        }
        if (i < count) { // the last slot of the stretch: nothing of the one before is left
            back = Algebra::join(in[i], back);
            out[i] = back;
            cells[i] = in[i];
        }
        state_.back = back;
        state_.fill += count;
    }

    // Slots after the last sample: the window empties.
    void expire(double* out, std::size_t count) noexcept {
        double* cells = ring_ + state_.fill;
        const std::size_t inner =
            state_.front ? std::min(count, width_ - state_.fill - 1) : std::size_t{0};
        for (std::size_t i = 0; i < inner; ++i)
            out[i] = Algebra::join(state_.back, cells[i + 1]);
        fill_cells(out + inner, count - inner, state_.back);
        fill_cells(cells, count, Algebra::identity);
        state_.fill += count;
    }
};

} // namespace rtamt::discrete
