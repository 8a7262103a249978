// The undefined values of a block.
//
// Cost: one pass over the block, vectorised.
#pragma once

#include "../values/real.hpp"
#include "../values/vectors.hpp"
#include "kernel.hpp"

#include <bit>
#include <cstddef>
#include <cstdint>

namespace rtamt::discrete {

// Whether any value of a block is undefined.
template <ValueDomain D>
class Undefined {
  public:
    RTAMT_INLINE void check(const typename D::Value& value) noexcept {
        seen_ |= D::undefined(value);
    }
    [[nodiscard]] bool seen() const noexcept { return seen_; }

  private:
    bool seen_ = false;
};

// Without its sign, a double is NaN if and only if its bits are above those of infinity; adding
// what lies between these and the top bit shows that in the top bit. Unlike a comparison with
// itself, that fills vectors on every machine.
template <>
class Undefined<Real> {
  public:
    RTAMT_INLINE void check(double value) noexcept {
        seen_ |= (std::bit_cast<std::uint64_t>(value) & magnitude) + above;
    }
    [[nodiscard]] bool seen() const noexcept { return seen_ > magnitude; }

  private:
    static constexpr std::uint64_t magnitude = ~std::uint64_t{0} >> 1U;
    static constexpr std::uint64_t above = magnitude - std::bit_cast<std::uint64_t>(infinity);
    std::uint64_t seen_ = 0;
};

// The first place of the range whose value is undefined, or `defined`.
template <ValueDomain D>
[[nodiscard]] std::size_t first_undefined(const typename D::Value* values, Range range) noexcept {
    Undefined<D> undefined;
    for (std::size_t i = range.begin; i < range.end; ++i)
        undefined.check(values[i]);
    if (!undefined.seen()) [[likely]] {
        return Kernel::defined;
    }
    std::size_t place = range.begin;
    while (!D::undefined(values[place]))
        ++place;
    return place;
}

} // namespace rtamt::discrete
