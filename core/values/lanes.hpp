// The domain of n traces at once: one robustness a lane.
//
// Each operation is a loop over the lanes without a branch. Max and min are written with the vector
// instructions that every x86-64 has, whose results are those of the scalar ones to the bit:
// compilers do not find them in the loop, and they halve the cost of a window. One lane never looks
// at another, so each trace gets the bits that it gets alone.
//
// Cost and memory: those of n reals.
#pragma once

#include "real.hpp"

#include <array>
#include <cstddef>
#include <type_traits>

#if defined(__SSE2__) || defined(_M_X64)
#define RTAMT_SSE2
#include <emmintrin.h>
#endif

namespace rtamt {

template <std::size_t n>
struct Lanes {
    struct Value {
        std::array<double, n> lane;
        [[nodiscard]] friend constexpr bool operator==(const Value& a, const Value& b) noexcept {
            bool equal = true;
            for (std::size_t i = 0; i < n; ++i)
                equal &= a.lane[i] == b.lane[i];
            return equal;
        }
    };
    using Number = Lanes;

    // The value whose lane i is f(i).
    template <class F>
    [[nodiscard]] static constexpr Value each(F&& f) noexcept {
        Value value; // NOLINT(*-pro-type-member-init): every lane is written
        for (std::size_t i = 0; i < n; ++i)
            value.lane[i] = f(i);
        return value;
    }

    [[nodiscard]] static constexpr Value of(double x) noexcept {
        return each([=](std::size_t) { return x; });
    }

    static constexpr Value bottom = of(Real::bottom);
    static constexpr Value top = of(Real::top);
    static constexpr bool total = n == 1;

    [[nodiscard]] static constexpr Value join(const Value& a, const Value& b) noexcept {
        return extremum<true>(a, b);
    }
    [[nodiscard]] static constexpr Value meet(const Value& a, const Value& b) noexcept {
        return extremum<false>(a, b);
    }
    [[nodiscard]] static constexpr Value neg(const Value& a) noexcept {
        return each([&](std::size_t i) { return Real::neg(a.lane[i]); });
    }
    [[nodiscard]] static bool undefined(const Value& a) noexcept {
        bool undefined = false;
        for (std::size_t i = 0; i < n; ++i)
            undefined |= Real::undefined(a.lane[i]);
        return undefined;
    }

    template <class Function>
    [[nodiscard]] static Value apply(const Value& a) noexcept {
        return each([&](std::size_t i) { return Function::of(a.lane[i]); });
    }
    template <class Function>
    [[nodiscard]] static Value apply(const Value& a, const Value& b) noexcept {
        return each([&](std::size_t i) { return Function::of(a.lane[i], b.lane[i]); });
    }

  private:
    template <bool most>
    [[nodiscard]] static constexpr double extremum(double a, double b) noexcept {
        return most ? Real::join(a, b) : Real::meet(a, b);
    }

    template <bool most>
    [[nodiscard]] static constexpr Value extremum(const Value& a, const Value& b) noexcept {
#ifdef RTAMT_SSE2
        if (!std::is_constant_evaluated()) {
            Value value; // NOLINT(*-pro-type-member-init): every lane is written
            for (std::size_t i = 0; i + 1 < n; i += 2) {
                const __m128d x = _mm_loadu_pd(a.lane.data() + i);
                const __m128d y = _mm_loadu_pd(b.lane.data() + i);
                _mm_storeu_pd(value.lane.data() + i, most ? _mm_max_pd(x, y) : _mm_min_pd(x, y));
            }
            if constexpr (n % 2 != 0) {
                value.lane[n - 1] = extremum<most>(a.lane[n - 1], b.lane[n - 1]);
            }
            return value;
        }
#endif
        return each([&](std::size_t i) { return extremum<most>(a.lane[i], b.lane[i]); });
    }
};

static_assert(UniformDomain<Lanes<8>>);

} // namespace rtamt
