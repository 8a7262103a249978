// Traces, a row of numbers each, to and from values with a lane for each trace.
//
// Cost: three operations for two numbers. The number of lanes is even. Of each pair of lanes a few
// cache lines are moved at a time, so that the values stay in the first cache for the other pairs.
#pragma once

#include "../values/lanes.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace rtamt::discrete {

template <class Row, std::size_t n>
using LaneRows = std::array<Row*, n>;

// Samples that are moved at a time.
inline constexpr std::size_t lane_piece = 64;

template <std::size_t n>
void gather(const LaneRows<const double, n>& rows, std::size_t count,
            typename Lanes<n>::Value* values) noexcept {
    for (std::size_t done = 0; done < count; done += lane_piece) {
        const std::size_t part = std::min(lane_piece, count - done);
        auto* to = values + done;
        for (std::size_t lane = 0; lane < n; lane += 2) {
            const double* a = rows[lane] + done;
            const double* b = rows[lane + 1] + done;
            std::size_t i = 0;
#ifdef RTAMT_SSE2
            for (; i + 2 <= part; i += 2) {
                const __m128d x = _mm_loadu_pd(a + i);
                const __m128d y = _mm_loadu_pd(b + i);
                _mm_storeu_pd(to[i].lane.data() + lane, _mm_unpacklo_pd(x, y));
                _mm_storeu_pd(to[i + 1].lane.data() + lane, _mm_unpackhi_pd(x, y));
            }
#endif
            for (; i < part; ++i) {
                to[i].lane[lane] = a[i];
                to[i].lane[lane + 1] = b[i];
            }
        }
    }
}

template <std::size_t n>
void scatter(const typename Lanes<n>::Value* values, std::size_t count,
             const LaneRows<double, n>& rows) noexcept {
    for (std::size_t done = 0; done < count; done += lane_piece) {
        const std::size_t part = std::min(lane_piece, count - done);
        const auto* from = values + done;
        for (std::size_t lane = 0; lane < n; lane += 2) {
            double* a = rows[lane] + done;
            double* b = rows[lane + 1] + done;
            std::size_t i = 0;
#ifdef RTAMT_SSE2
            for (; i + 2 <= part; i += 2) {
                const __m128d x = _mm_loadu_pd(from[i].lane.data() + lane);
                const __m128d y = _mm_loadu_pd(from[i + 1].lane.data() + lane);
                _mm_storeu_pd(a + i, _mm_unpacklo_pd(x, y));
                _mm_storeu_pd(b + i, _mm_unpackhi_pd(x, y));
            }
#endif
            for (; i < part; ++i) {
                a[i] = from[i].lane[lane];
                b[i] = from[i].lane[lane + 1];
            }
        }
    }
}

} // namespace rtamt::discrete
