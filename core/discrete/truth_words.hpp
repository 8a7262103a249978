// Truth values, +inf or -inf, as bits of a word: 1 where a value is +inf, the first value lowest.
//
// Cost: less than an operation a value each way.
#pragma once

#include "../values/algebra.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#if defined(__SSE2__) || defined(_M_X64)
#include <emmintrin.h>
#define RTAMT_SIGNS
#endif

namespace rtamt::discrete {

using TruthWord = std::uint64_t;
inline constexpr std::size_t truth_word_bits = 64;

[[nodiscard]] constexpr double truth_number(bool holds) noexcept {
    return holds ? Real::top : Real::bottom;
}

// The lowest `count` bits, at least one and at most all.
[[nodiscard]] constexpr TruthWord lowest_bits(std::size_t count) noexcept {
    return ~TruthWord{0} >> (truth_word_bits - count);
}

namespace detail {

inline constexpr std::size_t signs_at_once = 8;

// The sign bits of eight values.
[[nodiscard]] inline TruthWord signs(const double* values) noexcept {
#ifdef RTAMT_SIGNS
    const auto pair = [values](std::size_t i) {
        return static_cast<unsigned>(_mm_movemask_pd(_mm_loadu_pd(values + i)));
    };
    return (pair(0) | (pair(2) << 2U)) | ((pair(4) << 4U) | (pair(6) << 6U));
#else
    TruthWord word = 0;
    for (std::size_t i = 0; i < signs_at_once; ++i)
        word |= (std::bit_cast<TruthWord>(values[i]) >> (truth_word_bits - 1)) << i;
    return word;
#endif
}

// The values of four bits.
inline constexpr std::size_t numbers_at_once = 4;
using TruthNumbers = std::array<double, numbers_at_once>;
inline constexpr auto truth_numbers = [] {
    std::array<TruthNumbers, std::size_t{1} << numbers_at_once> table{};
    for (std::size_t bits = 0; bits < table.size(); ++bits) {
        for (std::size_t i = 0; i < numbers_at_once; ++i)
            table[bits][i] = truth_number(((bits >> i) & 1U) != 0);
    }
    return table;
}();

} // namespace detail

// The bits of at most 64 values; those above are 0.
[[nodiscard]] inline TruthWord pack_truth(const double* values, std::size_t count) noexcept {
    TruthWord word = 0;
    std::size_t i = 0;
    for (; i + detail::signs_at_once <= count; i += detail::signs_at_once)
        word |= (detail::signs(values + i) ^ lowest_bits(detail::signs_at_once)) << i;
    for (; i < count; ++i)
        word |= TruthWord{values[i] > 0} << i;
    return word;
}

// The values of at most 64 bits.
inline void unpack_truth(TruthWord word, std::size_t count, double* out) noexcept {
    constexpr std::size_t step = detail::numbers_at_once;
    std::size_t i = 0;
    for (; i + step <= count; i += step) {
        const auto& numbers = detail::truth_numbers[word & lowest_bits(step)];
        std::copy_n(numbers.data(), step, out + i);
        word >>= step;
    }
    for (; i < count; ++i) {
        out[i] = truth_number((word & 1U) != 0);
        word >>= 1U;
    }
}

} // namespace rtamt::discrete
