// The registers of one sort, numbers or formulas: a block of values each.
//
// Memory: a value a register until grow(), then a block. Cost: checkpoint() and rollback() copy a
// value for each register that a failed update overwrites.
#pragma once

#include "copy.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace rtamt::discrete {

template <class Value>
class Bank {
  public:
    // A new register; before at(). Returns its row.
    [[nodiscard]] std::uint32_t add() {
        cells_.emplace_back();
        return rows_++;
    }

    // Has samples of an input copied to a register.
    void take_input(std::uint32_t row, std::uint32_t instruction, std::size_t column) {
        inputs_.push_back({instruction, row, column, nullptr});
    }

    // Has a register filled with one value.
    void fill(std::uint32_t row, const Value& value) { constants_.push_back({row, value}); }

    // Has checkpoint() remember what the last slot of a register held.
    void protect(std::uint32_t row) { fragile_.push_back({row, nullptr, {}}); }
    void protect_nothing() noexcept { fragile_.clear(); }

    // Puts the registers `stride` values apart and keeps slot `last` of each, as the first;
    // settle() has to follow.
    void grow(std::size_t stride, std::size_t last) {
        std::vector<Value> larger(rows_ * stride);
        for (std::uint32_t row = 0; row < rows_; ++row)
            larger[row * stride] = at(row)[last];
        cells_ = std::move(larger);
        stride_ = stride;
    }

    // Puts the registers `stride` values apart, but some `short_stride` values, and keeps nothing;
    // settle() has to follow.
    void arrange(std::size_t stride, std::span<const std::uint32_t> short_rows,
                 std::size_t short_stride) {
        std::vector<std::size_t> sizes(rows_, stride);
        for (const std::uint32_t row : short_rows)
            sizes[row] = short_stride;
        offsets_.resize(rows_);
        std::exclusive_scan(sizes.begin(), sizes.end(), offsets_.begin(), std::size_t{0});
        cells_.assign(std::reduce(sizes.begin(), sizes.end()), Value{});
    }

    // After the last register was added, and whenever they have moved: they have `size` slots.
    void settle(std::size_t size) noexcept {
        for (const Constant& constant : constants_)
            std::fill_n(at(constant.row), size, constant.value);
        for (Input& input : inputs_)
            input.values = at(input.row);
        for (Fragile& fragile : fragile_)
            fragile.values = at(fragile.row);
    }

    [[nodiscard]] Value* at(std::uint32_t row) noexcept { return cells_.data() + offset(row); }
    [[nodiscard]] const Value* at(std::uint32_t row) const noexcept {
        return cells_.data() + offset(row);
    }
    [[nodiscard]] std::uint32_t rows() const noexcept { return rows_; }

    // One sample of every input.
    template <class Number>
    void load(const Number* samples) noexcept {
        for (const Input& input : inputs_)
            *input.values = samples[input.column];
    }

    // `count` samples from `offset` on of every input but those that are to be skipped.
    template <class Column, class Skip>
    void load(std::span<const Column> columns, std::size_t offset, std::size_t count,
              Skip&& skip) noexcept {
        for (const Input& input : inputs_) {
            if (skip(input.instruction)) continue;
            copy_values(static_cast<const Value*>(columns[input.column]) + offset, count,
                        input.values);
        }
    }

    void checkpoint(std::size_t last) noexcept {
        for (Fragile& fragile : fragile_)
            fragile.last = fragile.values[last];
    }
    void rollback(std::size_t last) noexcept {
        for (const Fragile& fragile : fragile_)
            fragile.values[last] = fragile.last;
    }

    [[nodiscard]] std::size_t bytes() const noexcept { return cells_.size() * sizeof(Value); }

  private:
    struct Input {
        std::uint32_t instruction;
        std::uint32_t row;
        std::size_t column;
        Value* values;
    };
    struct Constant {
        std::uint32_t row;
        Value value;
    };
    // A register that a failed update overwrites, and what its last slot held before.
    struct Fragile {
        std::uint32_t row;
        Value* values;
        Value last;
    };

    [[nodiscard]] std::size_t offset(std::uint32_t row) const noexcept {
        return offsets_.empty() ? row * stride_ : offsets_[row];
    }

    std::vector<Value> cells_;
    std::uint32_t rows_ = 0;
    std::size_t stride_ = 1;           // values from one register to the next
    std::vector<std::size_t> offsets_; // of registers, unless they are all as long
    std::vector<Input> inputs_;
    std::vector<Constant> constants_;
    std::vector<Fragile> fragile_;
};

} // namespace rtamt::discrete
