// As few cells of a set as possible, so that each of many windows has as many of them as it needs:
// what the explanation of a share of a window rests on.
//
// From left to right, each time those furthest to the right that are not taken yet: later windows
// use them, too. No cell can be left out, because no smaller set exists.
//
// Cost: a few operations a cell. Memory: a byte a cell, and an index for each that is not taken.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace rtamt::discrete {

// The cells in [begin, end).
struct CellRange {
    std::int64_t begin;
    std::int64_t end;
    bool operator==(const CellRange&) const = default;
};

class FewestCells {
  public:
    // The windows of the cells `asked` are [k + before, k + after], and contain `need` cells of
    // `found` or more. Ranges are in order and do not touch. Cells before 0 count, and are not to
    // be taken.
    FewestCells(std::span<const CellRange> asked, std::span<const CellRange> found,
                std::int64_t before, std::int64_t after, std::int64_t need)
        : before_(before), after_(after), need_(need) {
        if (asked.empty()) return;
        // Windows before the trace have what they need.
        const std::int64_t first = std::max(asked.front().begin, -after - 1);
        base_ = seen_ = left_ = std::min(first + before, first + after);
        const std::int64_t end = std::max(asked.back().end + after, base_);
        cells_.resize(static_cast<std::size_t>(end - base_), Cell::absent);
        for (const CellRange& range : found) {
            mark({range.begin, std::min(range.end, std::int64_t{0})}, Cell::counts);
            mark({std::max(range.begin, std::int64_t{0}), range.end}, Cell::free);
        }
        for (const CellRange& range : asked) {
            for (std::int64_t k = std::max(range.begin, first); k < range.end; ++k)
                satisfy(k);
        }
    }

    // The cells that were taken, in order.
    [[nodiscard]] std::vector<CellRange> taken() const {
        std::vector<CellRange> ranges;
        for (std::size_t i = 0; i < cells_.size(); ++i) {
            const std::int64_t cell = base_ + static_cast<std::int64_t>(i);
            if (cells_[i] != Cell::taken) continue;
            if (ranges.empty() || ranges.back().end != cell) ranges.push_back({cell, cell});
            ++ranges.back().end;
        }
        return ranges;
    }

  private:
    enum class Cell : std::uint8_t { absent, counts, free, taken };

    std::int64_t before_;
    std::int64_t after_;
    std::int64_t need_;
    std::int64_t base_ = 0; // the first cell of all windows
    std::vector<Cell> cells_;
    std::vector<std::int64_t> free_; // the cells that were seen and are free, the last one on top
    std::int64_t seen_ = 0;          // the first cell that is in no window yet
    std::int64_t left_ = 0;          // the first cell of the window
    std::int64_t inside_ = 0;        // how many cells of the window count

    [[nodiscard]] Cell& at(std::int64_t cell) noexcept {
        return cells_[static_cast<std::size_t>(cell - base_)];
    }

    void mark(const CellRange& range, Cell as) noexcept {
        const std::int64_t end = base_ + static_cast<std::int64_t>(cells_.size());
        for (std::int64_t cell = std::max(range.begin, base_); cell < std::min(range.end, end);
             ++cell)
            at(cell) = as;
    }

    [[nodiscard]] bool counts(std::int64_t cell) noexcept {
        return at(cell) == Cell::counts || at(cell) == Cell::taken;
    }

    void satisfy(std::int64_t k) {
        for (; seen_ <= k + after_; ++seen_) {
            inside_ += static_cast<std::int64_t>(counts(seen_));
            if (at(seen_) == Cell::free) free_.push_back(seen_);
        }
        for (; left_ < k + before_; ++left_)
            inside_ -= static_cast<std::int64_t>(counts(left_));
        while (inside_ < need_ && !free_.empty() && free_.back() >= left_) {
            at(free_.back()) = Cell::taken;
            free_.pop_back();
            ++inside_;
        }
    }
};

} // namespace rtamt::discrete
