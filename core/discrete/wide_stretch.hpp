// The loops of two_stack.hpp for extrema of doubles, four of them in a vector (AVX2).
//
// In a vector the extrema up to each place, or from it on, take two steps; only one comparison a
// vector then waits for the one before it.
#pragma once

#include "../values/algebra.hpp"
#include "../values/vectors.hpp"

#include <concepts>
#include <cstddef>

#ifdef RTAMT_WIDE
#include <immintrin.h>

namespace rtamt::discrete {

// All counts are rounded down to whole vectors; the results are how many values these were, or the
// new total.
template <class Algebra>
class WideStretch {
  public:
    static constexpr std::size_t lanes = 4;
    static constexpr std::size_t least = 16; // below which the call costs more than it saves

    // Replaces every cell by the total from there to the end, which begins with `tail`.
    RTAMT_WIDE static void flip(double* ring, std::size_t width, double tail) noexcept {
        Vector total = _mm256_set1_pd(tail);
        for (std::size_t i = width; i >= lanes; i -= lanes) {
            double* cells = ring + (i - lanes);
            const Vector here = onwards(_mm256_loadu_pd(cells));
            _mm256_storeu_pd(cells, join(here, total));
            total = join(_mm256_permute4x64_pd(here, first), total);
        }
    }

    [[nodiscard]] RTAMT_WIDE static double grow(const double* in, double* cells, double back,
                                                double* out, std::size_t count) noexcept {
        Vector total = _mm256_set1_pd(back);
        for (std::size_t i = 0; i + lanes <= count; i += lanes) {
            const Vector values = _mm256_loadu_pd(in + i);
            const Vector here = upto(values);
            _mm256_storeu_pd(out + i, join(here, total));
            _mm256_storeu_pd(cells + i, values);
            total = join(_mm256_permute4x64_pd(here, last), total);
        }
        return _mm256_cvtsd_f64(total);
    }

    [[nodiscard]] RTAMT_WIDE static double slide(const double* in, double* cells, double back,
                                                 double* out, std::size_t count) noexcept {
        Vector total = _mm256_set1_pd(back);
        for (std::size_t i = 0; i + lanes <= count; i += lanes) {
            const Vector values = _mm256_loadu_pd(in + i);
            const Vector here = upto(values);
            const Vector older = _mm256_loadu_pd(cells + i + 1);
            _mm256_storeu_pd(out + i, join(join(here, total), older));
            _mm256_storeu_pd(cells + i, values);
            total = join(_mm256_permute4x64_pd(here, last), total);
        }
        return _mm256_cvtsd_f64(total);
    }

  private:
    using Vector = __m256d;
    static constexpr int first = 0x00; // of all lanes of a permutation
    static constexpr int last = 0xFF;

    [[nodiscard]] RTAMT_WIDE static Vector join(Vector a, Vector b) noexcept {
        if constexpr (std::same_as<Algebra, Max>) {
            return _mm256_max_pd(a, b);
        } else {
            static_assert(std::same_as<Algebra, Min>);
            return _mm256_min_pd(a, b);
        }
    }
    // The total of the lanes up to each one, and from each one on.
    [[nodiscard]] RTAMT_WIDE static Vector upto(Vector a) noexcept {
        const Vector pairs = join(a, _mm256_permute_pd(a, 0b0000));
        return join(pairs, _mm256_permute4x64_pd(pairs, 0b01'01'01'00));
    }
    [[nodiscard]] RTAMT_WIDE static Vector onwards(Vector a) noexcept {
        const Vector pairs = join(a, _mm256_permute_pd(a, 0b1111));
        return join(pairs, _mm256_permute4x64_pd(pairs, 0b11'10'10'10));
    }
};

} // namespace rtamt::discrete
#endif
