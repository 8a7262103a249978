// An interpreter for chains of operations on doubles: each step is done for a strip of 32 samples,
// which stays in the processor's registers from one step to the next.
//
// Steps work on an accumulator and an operand in memory. The same code runs them for one sample,
// for the few samples of an online monitor.
//
// Cost: a jump and eight vector instructions a step and strip, a few more to look for NaN. No
// memory.
#pragma once

#include "../values/functions.hpp"
#include "../values/real.hpp"
#include "../values/vectors.hpp"
#include "step.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>

namespace rtamt::discrete {

namespace detail {

// Operations that differ between a number and a vector; `seen`: whether any was NaN.
RTAMT_INLINE void set_abs(double& x) noexcept {
    x = std::fabs(x);
}
RTAMT_INLINE void set_sqrt(double& x) noexcept {
    x = std::sqrt(x);
}
RTAMT_INLINE void look_for_nan(double x, bool& seen) noexcept {
    seen = seen || std::isnan(x);
}
RTAMT_INLINE bool any(bool seen) noexcept {
    return seen;
}

#if defined(__GNUC__)
inline constexpr std::size_t vector_lanes = 4;
using Vector [[gnu::vector_size(32)]] = double;
using Bits [[gnu::vector_size(32)]] = std::uint64_t;

RTAMT_INLINE void set_abs(Vector& x) noexcept {
    constexpr std::uint64_t magnitude = ~std::uint64_t{0} >> 1U;
    x = reinterpret_cast<Vector>(reinterpret_cast<Bits>(x) & (Bits{} + magnitude));
}
RTAMT_INLINE void set_sqrt(Vector& x) noexcept {
    x = Vector{std::sqrt(x[0]), std::sqrt(x[1]), std::sqrt(x[2]), std::sqrt(x[3])};
}
RTAMT_INLINE void look_for_nan(const Vector& x, Bits& seen) noexcept {
    seen |= reinterpret_cast<Bits>(x != x);
}
RTAMT_INLINE bool any(const Bits& seen) noexcept {
    return ((seen[0] | seen[1]) | (seen[2] | seen[3])) != 0;
}
#else
inline constexpr std::size_t vector_lanes = 1;
using Vector = double;
using Bits = bool;
#endif

// The accumulator: `n` values, or vectors of them, as many as leave registers for operands.
template <class V, std::size_t lanes, std::size_t n>
class Strip {
  public:
    using Value = V;

    Strip() = default;
    explicit Strip(const V& value) noexcept : values_{value} {}

    // Does act(x) for each value.
    template <class Act>
    RTAMT_INLINE void each(const Act& act) noexcept {
        each(act, std::make_index_sequence<n>{});
    }
    // Does act(x, y) for each value and its operand.
    template <class Act>
    RTAMT_INLINE void with(const double* operand, const Act& act) noexcept {
        with(operand, act, std::make_index_sequence<n>{});
    }
    // Does act(x, y, z) for each value and its two operands.
    template <class Act>
    RTAMT_INLINE void with(const double* operand, const double* other, const Act& act) noexcept {
        with(operand, other, act, std::make_index_sequence<n>{});
    }
    RTAMT_INLINE void store(double* memory) const noexcept {
        store(memory, std::make_index_sequence<n>{});
    }

  private:
    V values_[n]{};

    template <class Act, std::size_t... i>
    RTAMT_INLINE void each(const Act& act, std::index_sequence<i...> /*all*/) noexcept {
        (act(values_[i]), ...);
    }
    RTAMT_INLINE static void get(V& y, const double* memory) noexcept {
        std::memcpy(&y, memory, sizeof(V));
    }
    template <class Act>
    RTAMT_INLINE static void at(V& x, const double* operand, const Act& act) noexcept {
        V y;
        get(y, operand);
        act(x, y);
    }
    template <class Act>
    RTAMT_INLINE static void at(V& x, const double* operand, const double* other,
                                const Act& act) noexcept {
        V y;
        V z;
        get(y, operand);
        get(z, other);
        act(x, y, z);
    }
    template <class Act, std::size_t... i>
    RTAMT_INLINE void with(const double* operand, const Act& act,
                           std::index_sequence<i...> /*all*/) noexcept {
        (at(values_[i], operand + i * lanes, act), ...);
    }
    template <class Act, std::size_t... i>
    RTAMT_INLINE void with(const double* operand, const double* other, const Act& act,
                           std::index_sequence<i...> /*all*/) noexcept {
        (at(values_[i], operand + i * lanes, other + i * lanes, act), ...);
    }
    RTAMT_INLINE static void put(const V& x, double* memory) noexcept {
        const V value = x; // whose address is taken, so that the accumulator stays in registers
        std::memcpy(memory, &value, sizeof(V));
    }
    template <std::size_t... i>
    RTAMT_INLINE void store(double* memory, std::index_sequence<i...> /*all*/) const noexcept {
        (put(values_[i], memory + i * lanes), ...);
    }
};

// Runs the steps for the strip at `place`; notes in `seen` where a value that is to be checked is
// NaN.
template <class Strip, class Seen>
RTAMT_INLINE void run_steps(const Memory& memory, std::size_t place, Strip& strip,
                            Seen& seen) noexcept {
    using V = Strip::Value;
    const auto values = [&](std::uint32_t operand) {
        const Operand& found = memory.operands[operand];
        return static_cast<const double*>(found.values) + (place & found.moves);
    };
    const Step* const end = memory.steps.data() + memory.steps.size();
    for (const Step* step = memory.steps.data(); step != end; ++step) {
        const double* y = values(step->operand);
        switch (step->action) {
        case Action::load:
            strip.with(y, [](V& a, const V& b) { a = b; });
            break;
        case Action::store:
            strip.store(memory.stored + step->operand * memory.stride);
            break;
        case Action::neg:
            strip.each([](V& a) { a = -a; });
            break;
        case Action::abs:
            strip.each([](V& a) { set_abs(a); });
            break;
        case Action::sqrt:
            strip.each([](V& a) { set_sqrt(a); });
            break;
        case Action::add:
            strip.with(y, [](V& a, const V& b) { a = a + b; });
            break;
        case Action::sub:
            strip.with(y, [](V& a, const V& b) { a = a - b; });
            break;
        case Action::sub_back:
            strip.with(y, [](V& a, const V& b) { a = b - a; });
            break;
        case Action::mul:
            strip.with(y, [](V& a, const V& b) { a = a * b; });
            break;
        case Action::div:
            strip.with(y, [](V& a, const V& b) { a = a / (b + 0.0); });
            break;
        case Action::div_back:
            strip.with(y, [](V& a, const V& b) { a = b / (a + 0.0); });
            break;
        case Action::min:
            strip.with(y, [](V& a, const V& b) { a = a < b ? a : b; });
            break;
        case Action::min_back:
            strip.with(y, [](V& a, const V& b) { a = b < a ? b : a; });
            break;
        case Action::max:
            strip.with(y, [](V& a, const V& b) { a = a > b ? a : b; });
            break;
        case Action::max_back:
            strip.with(y, [](V& a, const V& b) { a = b > a ? b : a; });
            break;
        case Action::holds_gt:
            strip.with(y, [](V& a, const V& b) { a = a > b ? V{} + infinity : V{} - infinity; });
            break;
        case Action::holds_gt_back:
            strip.with(y, [](V& a, const V& b) { a = b > a ? V{} + infinity : V{} - infinity; });
            break;
        case Action::holds_ge:
            strip.with(y, [](V& a, const V& b) { a = a >= b ? V{} + infinity : V{} - infinity; });
            break;
        case Action::holds_ge_back:
            strip.with(y, [](V& a, const V& b) { a = b >= a ? V{} + infinity : V{} - infinity; });
            break;
        case Action::holds_eq:
            strip.with(y, [](V& a, const V& b) { a = a == b ? V{} + infinity : V{} - infinity; });
            break;
        case Action::at_least:
            strip.with(y, [](V& a, const V& b) { a = a >= b ? a : V{} + functions::undefined; });
            break;
        case Action::at_least_back:
            strip.with(y, [](V& a, const V& b) { a = b >= a ? b : V{} + functions::undefined; });
            break;
        case Action::add_both:
            strip.with(y, values(step->other), [](V& a, const V& b, const V& c) { a = b + c; });
            break;
        case Action::sub_both:
            strip.with(y, values(step->other), [](V& a, const V& b, const V& c) { a = b - c; });
            break;
        case Action::mul_both:
            strip.with(y, values(step->other), [](V& a, const V& b, const V& c) { a = b * c; });
            break;
        case Action::min_difference:
            strip.with(y, values(step->other), [](V& a, const V& b, const V& c) {
                const V d = b - c;
                a = a < d ? a : d;
            });
            break;
        case Action::max_difference:
            strip.with(y, values(step->other), [](V& a, const V& b, const V& c) {
                const V d = b - c;
                a = a > d ? a : d;
            });
            break;
        }
        if (step->checked) strip.each([&](const V& a) { look_for_nan(a, seen); });
    }
}

using Wide = Strip<Vector, vector_lanes, strip_width / vector_lanes>;
using Single = Strip<double, 1, 1>;

} // namespace detail

// Runs steps over `count` samples from `place` on, at least a strip of them; the last strip may do
// some of the one before again. Returns whether a value that was checked is NaN.
struct Strips {
    [[nodiscard]] RTAMT_INLINE static bool over(Memory memory, std::size_t place, std::size_t count,
                                                double* out) noexcept {
        detail::Bits seen{};
        const std::size_t end = place + count;
        for (; place != end; place += strip_width) {
            place = std::min(place, end - strip_width);
            detail::Wide strip;
            detail::run_steps(memory, place, strip, seen);
            strip.store(out + place);
        }
        return detail::any(seen);
    }
};

// The same for one sample, with `value` in the accumulator before and after.
[[nodiscard]] inline bool run_sample(const Memory& memory, std::size_t place,
                                     double& value) noexcept {
    bool seen = false;
    detail::Single strip(value);
    detail::run_steps(memory, place, strip, seen);
    strip.store(&value);
    return seen;
}

} // namespace rtamt::discrete
