// The order, the distance and the period of timestamps, as rtamt.signals has them to the bit
// (tests/laws/test_recording_laws.py).
#include "timestamps.hpp"

#include "../values/vectors.hpp"
#include "numbers.hpp"

#include <nanobind/nanobind.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace rtamt::python {

namespace {

// Whether a condition holds of all neighbours.
template <class Condition>
[[nodiscard]] bool holds_of_neighbours(std::span<const double> times,
                                       Condition condition) noexcept {
    struct Loop {
        RTAMT_INLINE static bool over(const double* times, std::size_t count,
                                      Condition condition) noexcept {
            double wrong = 0.0; // as wide as the times, for a loop of vector instructions
            for (std::size_t i = 1; i < count; ++i)
                wrong = condition(times[i - 1], times[i]) ? wrong : 1.0;
            return wrong == 0.0;
        }
    };
    return vectorised<Loop>(times.size(), times.data(), times.size(), condition);
}

} // namespace

bool ordered(std::span<const double> times, std::optional<double> before) noexcept {
    // Of times in order, all are as near as the first and the last; NaN is in no order.
    return (!before || times.front() > *before) && times.front() > -implausible &&
           times.back() < implausible &&
           holds_of_neighbours(times, [](double last, double time) { return time > last; });
}

bool regular(std::span<const double> times, std::optional<double> before, double period,
             double tolerance) noexcept {
    const double limit = tolerance * period;
    const auto within = [period, limit](double last, double time) {
        return !(std::fabs(time - last - period) > limit);
    };
    return (!before || within(*before, times.front())) && holds_of_neighbours(times, within);
}

namespace {

// The limits of infer_period(): `_COARSE`, `_UNCERTAIN`, that of gaps that do not differ, and
// `_ROUNDED` of rtamt.signals.resolution.
constexpr double coarse_precision = 1e-4;
constexpr double uncertain_precision = 1e-2;
constexpr double same_gap = 1e-6;
constexpr double rounded_precision = 1e-2;

// A sampling period, and between which numbers it lies.
struct Period {
    double length = 0.0;
    double least = 0.0;
    double most = 0.0;
};

// Whether doubles may have been floats of 32 bits.
[[nodiscard]] bool are_single(std::span<const double> times) noexcept {
    return std::ranges::all_of(
        times, [](double time) { return static_cast<double>(static_cast<float>(time)) == time; });
}

// Timestamps since 1970 have a precision of about 0.2 µs.
[[nodiscard]] double blur_of(double gap, std::span<const double> times) noexcept {
    const double largest = std::max(std::fabs(times.front()), std::fabs(times.back()));
    const double spacing =
        std::nextafter(largest, std::numeric_limits<double>::infinity()) - largest;
    return std::max(1e-6 * gap, 2.0 * spacing);
}

[[nodiscard]] double median_gap(std::span<const double> times) {
    std::vector<double> gaps(times.size() - 1);
    for (std::size_t i = 0; i < gaps.size(); ++i)
        gaps[i] = times[i + 1] - times[i];
    const auto middle = gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2);
    std::ranges::nth_element(gaps, middle);
    if (gaps.size() % 2 != 0) return *middle;
    return (*std::max_element(gaps.begin(), middle) + *middle) / 2.0;
}

// As mean_period() in rtamt.signals.resolution.
[[nodiscard]] std::optional<Period> mean_period(std::span<const double> times,
                                                double near) noexcept {
    const double mean = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
    double least = -std::numeric_limits<double>::infinity();
    double most = std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; i < times.size(); ++i) {
        const double since = times[i] - times.front();
        least = std::max(least, (since - near) / static_cast<double>(i));
        most = std::min(most, (since + near) / static_cast<double>(i));
    }
    const bool is_near = least <= mean && mean <= most; // false with NaN
    if (!is_near) return std::nullopt;
    const double millionth = 1e-6 * mean;
    return Period{mean, std::min(least, mean - millionth), std::max(most, mean + millionth)};
}

// As rounded_period() there.
[[nodiscard]] std::optional<Period> rounded_period(std::span<const double> times) noexcept {
    double shortest = std::numeric_limits<double>::infinity();
    double longest = 0.0;
    for (std::size_t i = 1; i < times.size(); ++i) {
        shortest = std::min(shortest, times[i] - times[i - 1]);
        longest = std::max(longest, times[i] - times[i - 1]);
    }
    const double range = longest - shortest;
    const auto gaps = static_cast<double>(times.size() - 1);
    const double mean = (times.back() - times.front()) / gaps;
    const double noise = blur_of(mean, times);
    if (range <= noise || 2.0 * range / gaps > rounded_precision * mean) return std::nullopt;
    const double step = range / 2.0;
    for (std::size_t i = 1; i < times.size(); ++i) {
        const double more = times[i] - times[i - 1] - shortest;
        if (std::fabs(more - std::rint(more / step) * step) > noise) return std::nullopt;
    }
    return mean_period(times, range + noise);
}

// As `_coarse_period` in rtamt.signals.inferred_period. Nothing for floats of 32 bits and errors.
[[nodiscard]] std::optional<Period> coarse_period(std::span<const double> times, double median,
                                                  bool differ) noexcept {
    if (differ && are_single(times)) return std::nullopt;
    const double blur = blur_of(median, times);
    const Period gap{median, median - blur, median + blur};
    if (!(blur > coarse_precision * median)) return gap;
    // The precision is that of the timestamps, then.
    const Period found = mean_period(times, 0.75 * blur).value_or(gap);
    const double limit = uncertain_precision * found.length;
    const bool certain = found.most - found.length <= limit && found.length - found.least <= limit;
    return certain ? std::optional(found) : std::nullopt;
}

} // namespace

std::optional<double> inferred_period(std::span<const double> times) {
    if (times.size() < 2) return 1.0;
    const double median = median_gap(times);
    const bool differ = !regular(times, {}, median, same_gap);
    std::optional<Period> found;
    if (differ) found = rounded_period(times);
    if (!found) found = coarse_period(times, median, differ);
    if (!found) return std::nullopt;
    for (int digits = 1; digits <= 16; ++digits) {
        char* text = PyOS_double_to_string(found->length, 'g', digits, 0, nullptr);
        if (text == nullptr) throw nb::python_error();
        const double shortest = PyOS_string_to_double(text, nullptr, nullptr);
        PyMem_Free(text);
        if (found->least <= shortest && shortest <= found->most) return shortest;
    }
    return found->length;
}

bool has_period(std::span<const double> times, double period, double coarse) noexcept {
    if (times.size() < 2) return true;
    const double blur = blur_of(period, times);
    std::uint64_t same = 0; // as wide as a double, for a loop of vector instructions
    for (std::size_t i = 1; i < times.size(); ++i) {
        const double gap = times[i] - times[i - 1];
        const bool near = std::fabs(gap - period) <= blur;
        const bool apart = std::fabs(gap - std::rint(gap / coarse) * coarse) > 1.001 * blur;
        same += static_cast<std::uint64_t>(near) & static_cast<std::uint64_t>(apart);
    }
    return 2 * same > times.size() - 1;
}

} // namespace rtamt::python
