// Traces, a row of numbers each, to and from values with a lane for each trace.
//
// Cost: three operations for two numbers. The number of lanes is even.
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
    for (std::size_t lane = 0; lane < n; lane += 2) {
        const double* a = rows[lane];
        const double* b = rows[lane + 1];
        std::size_t i = 0;
#ifdef RTAMT_SSE2
        for (; i + 2 <= count; i += 2) {
            const __m128d x = _mm_loadu_pd(a + i);
            const __m128d y = _mm_loadu_pd(b + i);
            _mm_storeu_pd(values[i].lane.data() + lane, _mm_unpacklo_pd(x, y));
            _mm_storeu_pd(values[i + 1].lane.data() + lane, _mm_unpackhi_pd(x, y));
        }
#endif
        for (; i < count; ++i) {
            values[i].lane[lane] = a[i];
            values[i].lane[lane + 1] = b[i];
        }
    }
}

template <std::size_t n>
void scatter(const typename Lanes<n>::Value* values, std::size_t count,
             const LaneRows<double, n>& rows) noexcept {
    for (std::size_t lane = 0; lane < n; lane += 2) {
        double* a = rows[lane];
        double* b = rows[lane + 1];
        std::size_t i = 0;
#ifdef RTAMT_SSE2
        for (; i + 2 <= count; i += 2) {
            const __m128d x = _mm_loadu_pd(values[i].lane.data() + lane);
            const __m128d y = _mm_loadu_pd(values[i + 1].lane.data() + lane);
            _mm_storeu_pd(a + i, _mm_unpacklo_pd(x, y));
            _mm_storeu_pd(b + i, _mm_unpackhi_pd(x, y));
        }
#endif
        for (; i < count; ++i) {
            a[i] = values[i].lane[lane];
            b[i] = values[i].lane[lane + 1];
        }
    }
}

} // namespace rtamt::discrete
