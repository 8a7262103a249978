// Until over the last w slots, oldest to newest: max(psi_0, min(phi_0, max(psi_1, min(phi_1,
// ...)))).
//
// A slot is the map x -> max(psi, min(phi, x)); such maps are closed under composition (Clamp in
// algebra.hpp), so this is an aggregation over a sliding window of a monoid that does not commute,
// with the oldest map outermost, and the two stacks of window.hpp serve it as they serve max.
//
// Cost: about six comparisons a sample whatever w. Memory: two doubles a slot of the window, in one
// ring, touched as far as the trace has come.
#pragma once

#include "../algebra.hpp"
#include "../cells.hpp"
#include "../journal.hpp"
#include "../kernel.hpp"

namespace rtamt::discrete {

class Until final : public Kernel {
  public:
    // The ring and the journal hold two doubles a slot.
    Until(std::int64_t operand_lag, std::size_t width, double* ring, double* journal) noexcept
        : Kernel(operand_lag), ring_(ring), width_(width), journal_(journal) {}

    std::size_t run(const Block& block) noexcept override {
        const Range present = block.present(lag());
        // Before their first sample the operands leave nothing behind: the ring starts with it.
        fill_cells(out(), present.begin, Max::identity);
        for (std::size_t i = present.begin; i < present.end;) {
            const std::size_t count = room(present.end - i);
            state_.front ? slide(a() + i, b() + i, out() + i, count)
                         : grow(a() + i, b() + i, out() + i, count);
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
            journal_.save(ring_, 2 * state_.fill, state_.front ? 2 * count : 0);
        } else {
            journal_.save(ring_, 0, 2 * (state_.front ? width_ : state_.fill));
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
        snapshot.cells(ring_, 2 * (state_.front ? width_ : state_.fill));
    }

  private:
    struct State {
        std::size_t fill = 0;
        Clamp back;         // composition of the slots of this stretch
        bool front = false; // whether there was a stretch before this one
    };

    double* ring_;
    std::size_t width_;
    State state_;
    State saved_;
    Journal journal_;

    static void store(double* cell, const Clamp& clamp) noexcept {
        cell[0] = clamp.low;
        cell[1] = clamp.high;
    }

    [[nodiscard]] static Clamp load(const double* cell) noexcept { return {cell[0], cell[1]}; }

    // How many of `count` slots fit into this stretch, after ending it if it is full.
    [[nodiscard]] std::size_t room(std::size_t count) noexcept {
        if (state_.fill == width_) flip();
        return std::min(count, width_ - state_.fill);
    }

    // Replaces every cell by the composition from there to the end.
    void flip() noexcept {
        Clamp tail;
        for (std::size_t i = width_; i > 0; --i) {
            double* cell = ring_ + 2 * (i - 1);
            tail = load(cell).after(tail);
            store(cell, tail);
        }
        state_ = {0, {}, true};
    }

    // The first stretch of a trace: nothing before it.
    void grow(const double* phi, const double* psi, double* out, std::size_t count) noexcept {
        Clamp back = state_.back;
        double* cell = ring_ + 2 * state_.fill;
        for (std::size_t i = 0; i < count; ++i, cell += 2) {
            const Clamp here{psi[i], phi[i]};
            back = back.after(here);
            out[i] = back.low;
            store(cell, here);
        }
        state_.back = back;
        state_.fill += count;
    }

    // Any later stretch. A cell is read for the slot before the one that overwrites it.
    void slide(const double* phi, const double* psi, double* out, std::size_t count) noexcept {
        Clamp back = state_.back;
        double* cell = ring_ + 2 * state_.fill;
        const std::size_t inner = std::min(count, width_ - state_.fill - 1);
        for (std::size_t i = 0; i < inner; ++i, cell += 2) {
            const Clamp here{psi[i], phi[i]};
            back = back.after(here);
            out[i] = load(cell + 2).at(back.low);
            store(cell, here);
        }
        if (inner < count) { // the last slot of the stretch: nothing of the one before is left
            const Clamp here{psi[inner], phi[inner]};
            back = back.after(here);
            out[inner] = back.low;
            store(cell, here);
        }
        state_.back = back;
        state_.fill += count;
    }

    // Slots after the last sample: the window empties.
    void expire(double* out, std::size_t count) noexcept {
        double* cell = ring_ + 2 * state_.fill;
        const std::size_t inner =
            state_.front ? std::min(count, width_ - state_.fill - 1) : std::size_t{0};
        for (std::size_t i = 0; i < inner; ++i) {
            out[i] = load(cell + 2 * (i + 1)).at(state_.back.low);
        }
        fill_cells(out + inner, count - inner, state_.back.low);
        for (std::size_t i = 0; i < count; ++i)
            store(cell + 2 * i, {});
        state_.fill += count;
    }
};

} // namespace rtamt::discrete
