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

// Operations that differ between a number and a vector; `seen`: whether x or y was ever NaN.
RTAMT_INLINE void set_abs(double& x) noexcept {
    x = std::fabs(x);
}
RTAMT_INLINE void set_sqrt(double& x) noexcept {
    x = std::sqrt(x);
}
RTAMT_INLINE void look_for_nan(double x, double y, bool& seen) noexcept {
    seen = seen || std::isunordered(x, y);
}
RTAMT_INLINE bool any(bool seen) noexcept {
    return seen;
}

#if defined(__GNUC__)
[[noreturn]] RTAMT_INLINE void unreachable() noexcept {
    __builtin_unreachable();
}
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
RTAMT_INLINE void look_for_nan(const Vector& x, const Vector& y, Bits& seen) noexcept {
    const auto bits = [&](int i) { return std::isunordered(x[i], y[i]) ? ~std::uint64_t{0} : 0; };
    seen |= Bits{bits(0), bits(1), bits(2), bits(3)}; // one comparison of vectors
}
RTAMT_INLINE bool any(const Bits& seen) noexcept {
    return ((seen[0] | seen[1]) | (seen[2] | seen[3])) != 0;
}
#else
[[noreturn]] inline void unreachable() noexcept {
    __assume(0);
}
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
    // Notes in `seen` whether a value is NaN.
    template <class Seen>
    RTAMT_INLINE void check(Seen& seen) const noexcept {
        check(seen, std::make_index_sequence<(n + 1) / 2>{});
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
    template <class Seen, std::size_t... i>
    RTAMT_INLINE void check(Seen& seen, std::index_sequence<i...> /*half*/) const noexcept {
        (look_for_nan(values_[i], values_[n - 1 - i], seen), ...);
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

// How far the sum or the difference of two operands lies over or under a limit.
struct SumOver {
    template <class V>
    RTAMT_INLINE static void set(V& term, const V& b, const V& c, const V& limit) noexcept {
        term = (b + c) - limit;
    }
};
struct SumUnder {
    template <class V>
    RTAMT_INLINE static void set(V& term, const V& b, const V& c, const V& limit) noexcept {
        term = limit - (b + c);
    }
};
struct DifferenceOver {
    template <class V>
    RTAMT_INLINE static void set(V& term, const V& b, const V& c, const V& limit) noexcept {
        term = (b - c) - limit;
    }
};
struct DifferenceUnder {
    template <class V>
    RTAMT_INLINE static void set(V& term, const V& b, const V& c, const V& limit) noexcept {
        term = limit - (b - c);
    }
};

// Runs the steps for the strip at `place`; notes in `seen` where a value that is to be checked is
// NaN.
template <class Strip, class Seen>
RTAMT_INLINE void run_steps(const Memory& memory, std::size_t place, Strip& strip,
                            Seen& seen) noexcept {
    using V = Strip::Value;
    const auto values = [&](std::uint32_t operand) {
        return static_cast<const double*>(memory.values[operand]) + (place & memory.moves[operand]);
    };
    const auto column = [&](std::uint32_t operand) {
        return static_cast<const double*>(memory.values[operand]) + place;
    };
    // Does act(x, term) for each value and the term of its operands.
    const auto with_term = [&]<class Term>(const Step& step, Term /*term*/, const auto& act) {
        V limit;
        std::memcpy(&limit, memory.values[step.limit], sizeof(V));
        strip.with(column(step.operand), column(step.other), [&](V& a, const V& b, const V& c) {
            V term;
            Term::set(term, b, c, limit);
            act(a, term);
        });
    };
    const auto take = [](V& a, const V& term) { a = term; };
    const auto least = [&](V& a, const V& term) {
        look_for_nan(a, term, seen);
        a = a < term ? a : term;
    };
    const auto most = [&](V& a, const V& term) {
        look_for_nan(a, term, seen);
        a = a > term ? a : term;
    };
    const Step* const end = memory.steps.data() + memory.steps.size();
    for (const Step* step = memory.steps.data(); step != end; ++step) {
        const auto y = [&] { return values(step->operand); };
        switch (step->action) {
        case Action::load:
            strip.with(y(), [](V& a, const V& b) { a = b; });
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
            strip.with(y(), [](V& a, const V& b) { a = a + b; });
            break;
        case Action::sub:
            strip.with(y(), [](V& a, const V& b) { a = a - b; });
            break;
        case Action::sub_back:
            strip.with(y(), [](V& a, const V& b) { a = b - a; });
            break;
        case Action::mul:
            strip.with(y(), [](V& a, const V& b) { a = a * b; });
            break;
        case Action::div:
            strip.with(y(), [](V& a, const V& b) { a = a / (b + 0.0); });
            break;
        case Action::div_back:
            strip.with(y(), [](V& a, const V& b) { a = b / (a + 0.0); });
            break;
        case Action::min:
            strip.with(y(), [](V& a, const V& b) { a = a < b ? a : b; });
            break;
        case Action::min_back:
            strip.with(y(), [](V& a, const V& b) { a = b < a ? b : a; });
            break;
        case Action::max:
            strip.with(y(), [](V& a, const V& b) { a = a > b ? a : b; });
            break;
        case Action::max_back:
            strip.with(y(), [](V& a, const V& b) { a = b > a ? b : a; });
            break;
        case Action::holds_gt:
            strip.with(y(), [](V& a, const V& b) { a = a > b ? V{} + infinity : V{} - infinity; });
            break;
        case Action::holds_gt_back:
            strip.with(y(), [](V& a, const V& b) { a = b > a ? V{} + infinity : V{} - infinity; });
            break;
        case Action::holds_ge:
            strip.with(y(), [](V& a, const V& b) { a = a >= b ? V{} + infinity : V{} - infinity; });
            break;
        case Action::holds_ge_back:
            strip.with(y(), [](V& a, const V& b) { a = b >= a ? V{} + infinity : V{} - infinity; });
            break;
        case Action::holds_eq:
            strip.with(y(), [](V& a, const V& b) { a = a == b ? V{} + infinity : V{} - infinity; });
            break;
        case Action::at_least:
            strip.with(y(), [](V& a, const V& b) { a = a >= b ? a : V{} + functions::undefined; });
            break;
        case Action::at_least_back:
            strip.with(y(), [](V& a, const V& b) { a = b >= a ? b : V{} + functions::undefined; });
            break;
        case Action::add_both:
            strip.with(y(), values(step->other), [](V& a, const V& b, const V& c) { a = b + c; });
            break;
        case Action::sub_both:
            strip.with(y(), values(step->other), [](V& a, const V& b, const V& c) { a = b - c; });
            break;
        case Action::mul_both:
            strip.with(y(), values(step->other), [](V& a, const V& b, const V& c) { a = b * c; });
            break;
        case Action::min_difference:
            strip.with(y(), values(step->other), [](V& a, const V& b, const V& c) {
                const V d = b - c;
                a = a < d ? a : d;
            });
            break;
        case Action::max_difference:
            strip.with(y(), values(step->other), [](V& a, const V& b, const V& c) {
                const V d = b - c;
                a = a > d ? a : d;
            });
            break;
        case Action::sum_over:
            with_term(*step, SumOver{}, take);
            break;
        case Action::min_sum_over:
            with_term(*step, SumOver{}, least);
            continue;
        case Action::max_sum_over:
            with_term(*step, SumOver{}, most);
            continue;
        case Action::sum_under:
            with_term(*step, SumUnder{}, take);
            break;
        case Action::min_sum_under:
            with_term(*step, SumUnder{}, least);
            continue;
        case Action::max_sum_under:
            with_term(*step, SumUnder{}, most);
            continue;
        case Action::difference_over:
            with_term(*step, DifferenceOver{}, take);
            break;
        case Action::min_difference_over:
            with_term(*step, DifferenceOver{}, least);
            continue;
        case Action::max_difference_over:
            with_term(*step, DifferenceOver{}, most);
            continue;
        case Action::difference_under:
            with_term(*step, DifferenceUnder{}, take);
            break;
        case Action::min_difference_under:
            with_term(*step, DifferenceUnder{}, least);
            continue;
        case Action::max_difference_under:
            with_term(*step, DifferenceUnder{}, most);
            continue;
        default: // which GCC would look for
            unreachable();
        }
        if (step->checked) strip.check(seen);
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
        constexpr std::size_t line = 64 / sizeof(double);
        const std::size_t last = place + count - strip_width;
        // The second strip begins with a cache line of the results, which columns often share.
        std::size_t stride =
            strip_width - reinterpret_cast<std::uintptr_t>(out + place) / sizeof(double) % line;
        detail::Wide strip;
        while (true) {
            detail::run_steps(memory, place, strip, seen);
            strip.store(out + place);
            if (place == last) break;
            place = std::min(place + stride, last);
            stride = strip_width;
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
