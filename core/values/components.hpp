// The doubles that a value consists of, one by one, and doubles as integers of the same order: for
// kernels that sort.
//
// Of two zeros the negative one is the smaller, so that what is sorted does not depend on how it
// came.
#pragma once

#include "interval.hpp"
#include "lanes.hpp"
#include "real.hpp"
#include "truth.hpp"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace rtamt {

template <class D>
struct Components;

template <>
struct Components<Real> {
    static constexpr std::size_t count = 1;
    [[nodiscard]] static double get(double value, std::size_t) noexcept { return value; }
    static void set(double& value, std::size_t, double component) noexcept { value = component; }
};

template <>
struct Components<Interval> {
    static constexpr std::size_t count = 2;
    [[nodiscard]] static double get(const Bounds& value, std::size_t i) noexcept {
        return i == 0 ? value.lower : value.upper;
    }
    static void set(Bounds& value, std::size_t i, double component) noexcept {
        (i == 0 ? value.lower : value.upper) = component;
    }
};

template <std::size_t n>
struct Components<Lanes<n>> {
    using Value = typename Lanes<n>::Value;
    static constexpr std::size_t count = n;
    [[nodiscard]] static double get(const Value& value, std::size_t i) noexcept {
        return value.lane[i];
    }
    static void set(Value& value, std::size_t i, double component) noexcept {
        value.lane[i] = component;
    }
};

template <>
struct Components<Truth> {
    static constexpr std::size_t count = Truth::traces;
    [[nodiscard]] static double get(Truth::Value value, std::size_t i) noexcept {
        return (value >> i & 1U) != 0 ? 1.0 : 0.0;
    }
    static void set(Truth::Value& value, std::size_t i, double component) noexcept {
        const Truth::Value bit = Truth::Value{1} << i;
        value = component > 0.0 ? value | bit : value & ~bit;
    }
};

// The order of doubles as that of integers; with `least` the order itself, else the reverse.
template <bool least>
struct Key {
    [[nodiscard]] static std::int64_t of(double value) noexcept {
        const std::int64_t key = turned(std::bit_cast<std::int64_t>(value));
        return least ? key : reversed(key);
    }
    [[nodiscard]] static double value(std::int64_t key) noexcept {
        return std::bit_cast<double>(turned(least ? key : reversed(key)));
    }

  private:
    // Negative doubles are ordered the other way round; twice the same is the identity.
    [[nodiscard]] static std::int64_t turned(std::int64_t bits) noexcept {
        return bits < 0 ? std::numeric_limits<std::int64_t>::min() + reversed(bits) : bits;
    }
    // Greater for smaller ones, and twice the same is the identity; -x would overflow.
    [[nodiscard]] static std::int64_t reversed(std::int64_t key) noexcept { return -1 - key; }
};

} // namespace rtamt
