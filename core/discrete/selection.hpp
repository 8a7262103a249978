// The c-th smallest of the keys in the slots of a window: two heaps, in which every slot knows its
// place.
//
// The c smallest keys are a heap with the greatest of them at the root, the rest one with the least
// at its root. A slot that gets another key stays in its heap, and the roots change places where
// they must.
//
// Cost: O(log w) a change. Memory: 24 bytes a slot, touched as far as slots are used.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

namespace rtamt::discrete {

class Selection {
  public:
    using Key = std::int64_t;

  private:
    struct Cell {
        Key key;
        std::size_t slot;
    };

  public:
    // Bytes of memory for each slot, aligned like doubles.
    static constexpr std::size_t slot_size = sizeof(Cell) + sizeof(std::size_t);

    Selection(std::size_t width, std::size_t order, void* memory) noexcept
        : cells_(static_cast<Cell*>(memory)),
          places_(reinterpret_cast<std::size_t*>(cells_ + width)),
          capacity_(std::min(order, width)), order_(order) {}

    void clear() noexcept { small_ = large_ = 0; }

    // Whether there are so many keys.
    [[nodiscard]] bool found() const noexcept { return small_ == order_; }
    [[nodiscard]] Key selected() const noexcept { return cells_[0].key; }

    // Of a slot that was used since clear().
    [[nodiscard]] bool contains(std::size_t slot) const noexcept { return places_[slot] != gone; }
    [[nodiscard]] Key key(std::size_t slot) const noexcept { return cells_[places_[slot]].key; }

    // Uses a slot without a key.
    void leave_out(std::size_t slot) noexcept { places_[slot] = gone; }

    void insert(std::size_t slot, Key key) noexcept {
        if (small_ < capacity_) {
            rise<true>(0, small_++, {key, slot});
            return;
        }
        Cell cell{key, slot};
        if (key < cells_[0].key) {
            const Cell root = cells_[0];
            sink<true>(0, small_, 0, cell);
            cell = root;
        }
        rise<false>(capacity_, large_++, cell);
    }

    void remove(std::size_t slot) noexcept {
        const std::size_t place = places_[slot];
        places_[slot] = gone;
        if (place >= capacity_) {
            drop<false>(capacity_, large_, place - capacity_);
            return;
        }
        drop<true>(0, small_, place);
        if (large_ == 0) return;
        const Cell root = cells_[capacity_];
        drop<false>(capacity_, large_, 0);
        rise<true>(0, small_++, root);
    }

    void replace(std::size_t slot, Key key) noexcept {
        const std::size_t place = places_[slot];
        if (place < capacity_) {
            settle<true>(0, small_, place, {key, slot});
        } else {
            settle<false>(capacity_, large_, place - capacity_, {key, slot});
        }
        if (large_ == 0 || cells_[capacity_].key >= cells_[0].key) return;
        const Cell small = cells_[0];
        sink<true>(0, small_, 0, cells_[capacity_]);
        sink<false>(capacity_, large_, 0, small);
    }

  private:
    static constexpr std::size_t gone = std::numeric_limits<std::size_t>::max();

    Cell* cells_;         // the heap of the small ones, from capacity_ on that of the rest
    std::size_t* places_; // by slot
    std::size_t capacity_;
    std::size_t order_;
    std::size_t small_ = 0;
    std::size_t large_ = 0;

    template <bool greatest>
    [[nodiscard]] static bool above(Key a, Key b) noexcept {
        return greatest ? a > b : a < b;
    }

    void put(std::size_t place, const Cell& cell) noexcept {
        cells_[place] = cell;
        places_[cell.slot] = place;
    }

    // Puts a cell at a place of a heap, or above.
    template <bool greatest>
    void rise(std::size_t base, std::size_t i, const Cell& cell) noexcept {
        while (i != 0) {
            const std::size_t parent = (i - 1) / 2;
            if (!above<greatest>(cell.key, cells_[base + parent].key)) break;
            put(base + i, cells_[base + parent]);
            i = parent;
        }
        put(base + i, cell);
    }

    // Puts a cell at a place of a heap, or below.
    template <bool greatest>
    void sink(std::size_t base, std::size_t size, std::size_t i, const Cell& value) noexcept {
        const Cell cell = value; // which may be one that is overwritten
        for (;;) {
            std::size_t child = 2 * i + 1;
            if (child >= size) break;
            if (child + 1 < size) {
                const Cell* cells = cells_ + base + child;
                child += static_cast<std::size_t>(above<greatest>(cells[1].key, cells[0].key));
            }
            if (!above<greatest>(cells_[base + child].key, cell.key)) break;
            put(base + i, cells_[base + child]);
            i = child;
        }
        put(base + i, cell);
    }

    template <bool greatest>
    void settle(std::size_t base, std::size_t size, std::size_t i, const Cell& cell) noexcept {
        if (i != 0 && above<greatest>(cell.key, cells_[base + (i - 1) / 2].key)) {
            rise<greatest>(base, i, cell);
        } else {
            sink<greatest>(base, size, i, cell);
        }
    }

    // Removes a place; the last cell takes it.
    template <bool greatest>
    void drop(std::size_t base, std::size_t& size, std::size_t i) noexcept {
        const Cell last = cells_[base + --size];
        if (i != size) settle<greatest>(base, size, i, last);
    }
};

} // namespace rtamt::discrete
