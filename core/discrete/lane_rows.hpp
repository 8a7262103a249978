// Traces, a row of numbers each, to and from values with a lane for each trace.
//
// Cost: three operations for two numbers. The lanes are an even number.
#pragma once

#include "../values/lanes.hpp"

#include <array>
#include <cstddef>

namespace rtamt::discrete {

template <class Row, std::size_t n>
using LaneRows = std::array<Row*, n>;

template <std::size_t n>
void gather(const LaneRows<const double, n>& rows, std::size_t count,
            typename Lanes<n>::Value* values) noexcept {
    std::size_t i = 0;
#ifdef RTAMT_SSE2
    for (; i + 2 <= count; i += 2) {
        for (std::size_t lane = 0; lane < n; lane += 2) {
            const __m128d a = _mm_loadu_pd(rows[lane] + i);
            const __m128d b = _mm_loadu_pd(rows[lane + 1] + i);
            _mm_storeu_pd(values[i].lane.data() + lane, _mm_unpacklo_pd(a, b));
            _mm_storeu_pd(values[i + 1].lane.data() + lane, _mm_unpackhi_pd(a, b));
        }
    }
#endif
    for (; i < count; ++i) {
        for (std::size_t lane = 0; lane < n; ++lane)
            values[i].lane[lane] = rows[lane][i];
    }
}

template <std::size_t n>
void scatter(const typename Lanes<n>::Value* values, std::size_t count,
             const LaneRows<double, n>& rows) noexcept {
    std::size_t i = 0;
#ifdef RTAMT_SSE2
    for (; i + 2 <= count; i += 2) {
        for (std::size_t lane = 0; lane < n; lane += 2) {
            const __m128d a = _mm_loadu_pd(values[i].lane.data() + lane);
            const __m128d b = _mm_loadu_pd(values[i + 1].lane.data() + lane);
            _mm_storeu_pd(rows[lane] + i, _mm_unpacklo_pd(a, b));
            _mm_storeu_pd(rows[lane + 1] + i, _mm_unpackhi_pd(a, b));
        }
    }
#endif
    for (; i < count; ++i) {
        for (std::size_t lane = 0; lane < n; ++lane)
            rows[lane][i] = values[i].lane[lane];
    }
}

} // namespace rtamt::discrete
