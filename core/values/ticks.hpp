// Ticks of dense time from seconds, and back. TimeScale in src/rtamt/signals/ticks.py is the same
// for Python callers.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>

namespace rtamt::ticks {

// Times stay this far from the ends of their range, so that bounds can be added to them.
inline constexpr double farthest = 0x1p62;

// Up to here a product of doubles is within half a tick of the truth; NEAR in counting.py.
inline constexpr double near = 0x1p50;

// Up to here every integer is a double.
inline constexpr double exact = 0x1p53;

// Numbers from here on are not times in seconds (IMPLAUSIBLE in counting.py explains why).
inline constexpr double implausible = 1e11;

// The tick of a time far from 0, where doubles are further apart than ticks: that of the shortest
// decimal that prints it (tick_of in counting.py says why).
[[nodiscard]] inline std::int64_t far_tick(double seconds, std::int64_t rate) noexcept {
    const double whole = std::trunc(seconds);
    const double rest = seconds - whole;
    const std::int64_t begin = static_cast<std::int64_t>(whole) * rate;
    if (rate % 1000 == 0) {
        for (const std::int64_t step : {1000, 100, 10}) {
            const std::int64_t steps_in_one = rate / step;
            const auto grid = static_cast<double>(steps_in_one);
            const double steps = std::nearbyint(rest * grid);
            if (whole + steps / grid == seconds) {
                return begin + static_cast<std::int64_t>(steps) * step;
            }
        }
    }
    return begin + static_cast<std::int64_t>(std::nearbyint(rest * static_cast<double>(rate)));
}

// The tick of a time, of which 1 is `rate` ticks: rounded to the nearest and halves to the even
// one; nothing for what is no time in seconds, or too far from 0.
[[nodiscard]] inline std::optional<std::int64_t> tick_of(double seconds, double rate) noexcept {
    const double tick = std::nearbyint(seconds * rate);
    if (!(std::fabs(tick) < farthest)) return std::nullopt;
    if (!(std::fabs(seconds) < implausible)) return std::nullopt;
    return std::fabs(tick) < near ? static_cast<std::int64_t>(tick)
                                  : far_tick(seconds, static_cast<std::int64_t>(rate));
}

// The double that is nearest to a tick divided by `rate`, at most 2^53.
[[nodiscard]] inline double nearest_to(std::int64_t tick, std::int64_t rate) noexcept {
    const auto number = static_cast<double>(tick);
    if (std::fabs(number) <= exact) return number / static_cast<double>(rate);
    // Long division, until there are more bits than a double has; the last one stands for the rest.
    const auto divisor = static_cast<std::uint64_t>(rate);
    const std::uint64_t size =
        tick < 0 ? 0 - static_cast<std::uint64_t>(tick) : static_cast<std::uint64_t>(tick);
    std::uint64_t bits = size / divisor;
    std::uint64_t rest = size % divisor;
    int exponent = 0;
    while (bits < std::uint64_t{1} << 54U) {
        rest *= 2;
        const bool one = rest >= divisor;
        if (one) rest -= divisor;
        bits = 2 * bits + (one ? 1 : 0);
        --exponent;
    }
    if (rest != 0) bits |= 1U;
    const double quotient = std::ldexp(static_cast<double>(bits), exponent);
    return tick < 0 ? -quotient : quotient;
}

// The time of a tick, of which `rate` are 1: the nearest double, or the next one where that is an
// instant before the tick (TimeScale._doubles in ticks.py says why).
[[nodiscard]] inline double seconds_of(std::int64_t tick, std::int64_t rate) noexcept {
    const double nearest = nearest_to(tick, rate);
    const double size = std::fabs(static_cast<double>(tick));
    if (size < near || size >= farthest - 0x1p12)
        return nearest; // doubles next to others are too far
    const auto read = tick_of(nearest, static_cast<double>(rate));
    return read && *read < tick ? std::nextafter(nearest, HUGE_VAL) : nearest;
}

} // namespace rtamt::ticks
