// The domain of n traces at once: one robustness a lane.
//
// Each operation is a loop over the lanes without a branch, which compilers turn into vectors. One
// lane never looks at another, so each trace gets the bits that it gets alone.
//
// Cost and memory: those of n reals.
#pragma once

#include "real.hpp"

#include <array>
#include <cstddef>

namespace rtamt {

template <std::size_t n>
struct Lanes {
    struct Value {
        std::array<double, n> lane;
        [[nodiscard]] friend bool operator==(const Value&, const Value&) = default;
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
        return each([&](std::size_t i) { return Real::join(a.lane[i], b.lane[i]); });
    }
    [[nodiscard]] static constexpr Value meet(const Value& a, const Value& b) noexcept {
        return each([&](std::size_t i) { return Real::meet(a.lane[i], b.lane[i]); });
    }
    [[nodiscard]] static constexpr Value neg(const Value& a) noexcept {
        return each([&](std::size_t i) { return Real::neg(a.lane[i]); });
    }
    [[nodiscard]] static constexpr bool same(const Value& a, const Value& b) noexcept {
        bool same = true;
        for (std::size_t i = 0; i < n; ++i)
            same &= Real::same(a.lane[i], b.lane[i]);
        return same;
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
};

static_assert(UniformDomain<Lanes<8>>);

} // namespace rtamt
