// Functions of the operands at the same instant: arithmetic, comparison, and, or, not.
//
// Cost: one pass over the block, vectorised where the function allows it; none where no operand is
// present. A constant operand is read once. No memory.
#pragma once

#include "../algebra.hpp"
#include "../kernel.hpp"
#include "../vectors.hpp"

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace rtamt::discrete {

namespace pointwise {

struct Neg {
    static constexpr bool partial = false;
    static double of(double a) noexcept { return -a; }
};
struct Abs {
    static constexpr bool partial = false;
    static double of(double a) noexcept { return std::fabs(a); }
};
struct Sqrt {
    static constexpr bool partial = true;
    static double of(double a) noexcept { return std::sqrt(a); }
};
struct Exp {
    static constexpr bool partial = false;
    static double of(double a) noexcept { return std::exp(a); }
};
struct Ln {
    static constexpr bool partial = true;
    static double of(double a) noexcept { return std::log(a); }
};
struct Add {
    static constexpr bool partial = true;
    static double of(double a, double b) noexcept { return a + b; }
};
struct Sub {
    static constexpr bool partial = true;
    static double of(double a, double b) noexcept { return a - b; }
};
struct Mul {
    static constexpr bool partial = true;
    static double of(double a, double b) noexcept { return a * b; }
};
struct Div {
    static constexpr bool partial = true;
    static double of(double a, double b) noexcept { return a / b; }
};
struct Pow {
    static constexpr bool partial = true;
    static double of(double a, double b) noexcept { return std::pow(a, b); }
};
struct Log { // of a to the base b
    static constexpr bool partial = true;
    static double of(double a, double b) noexcept { return std::log(a) / std::log(b); }
};

// Of 0.0 and -0.0, which 1/x tells apart, 0.0 is the larger, whatever the order of the operands.
// One order answers the one and the other order the other; all other results have the same bits.
template <class Algebra>
struct Join {
    static constexpr bool partial = false;
    static double of(double a, double b) noexcept {
        const auto first = std::bit_cast<std::uint64_t>(Algebra::join(a, b));
        const auto second = std::bit_cast<std::uint64_t>(Algebra::join(b, a));
        if constexpr (std::is_same_v<Algebra, Max>) {
            return std::bit_cast<double>(first & second);
        } else {
            return std::bit_cast<double>(first | second);
        }
    }
};
struct HoldsGreater {
    static constexpr bool partial = false;
    static double of(double a, double b) noexcept { return a > b ? infinity : -infinity; }
};
struct HoldsGreaterEqual {
    static constexpr bool partial = false;
    static double of(double a, double b) noexcept { return a >= b ? infinity : -infinity; }
};
struct HoldsEqual {
    static constexpr bool partial = false;
    static double of(double a, double b) noexcept { return a == b ? infinity : -infinity; }
};

} // namespace pointwise

// Evaluates `function(i)` for each place of the range; answers the first that is NaN, or `defined`.
//
// Without its sign, a double is NaN if and only if its bits are above those of infinity; adding
// what lies between these and the top bit shows that in the top bit. Unlike a comparison with
// itself, that fills vectors on every machine.
template <bool partial, class Function>
[[nodiscard]] RTAMT_INLINE std::size_t fill(double* __restrict out, Range range,
                                            Function&& function) noexcept {
    constexpr std::uint64_t magnitude = ~std::uint64_t{0} >> 1U;
    constexpr std::uint64_t above = magnitude - std::bit_cast<std::uint64_t>(infinity);
    std::uint64_t seen = 0;
    for (std::size_t i = range.begin; i < range.end; ++i) {
        const double value = function(i);
        out[i] = value;
        if constexpr (partial) seen |= (std::bit_cast<std::uint64_t>(value) & magnitude) + above;
    }
    if (seen <= magnitude) [[likely]] {
        return Kernel::defined;
    }
    std::size_t place = range.begin;
    while (!std::isnan(out[place]))
        ++place;
    return place;
}

template <class Function>
class Unary final : public Kernel {
  public:
    using Kernel::Kernel;

    std::size_t run(const Block& block) noexcept override {
        const Range range = block.present(lag());
        return vectorised<Unary>(range.end - range.begin, out(), a(), range);
    }

    [[nodiscard]] RTAMT_INLINE static std::size_t
    over(double* __restrict out, const double* __restrict a, Range range) noexcept {
        return fill<Function::partial>(out, range,
                                       [=](std::size_t i) { return Function::of(a[i]); });
    }

    void transfer(Snapshot& /*snapshot*/) override {}
};

// Which operands are the same number at every slot.
struct Same {
    bool a = false;
    bool b = false;
};

template <class Function>
class Binary final : public Kernel {
  public:
    explicit Binary(std::int64_t operand_lag, Same same = {}) noexcept
        : Kernel(operand_lag), same_(same) {}

    std::size_t run(const Block& block) noexcept override {
        const Range range = block.present(lag());
        const std::size_t count = range.end - range.begin;
        if (same_.b) return vectorised<Right>(count, out(), a(), *b(), range);
        if (same_.a) return vectorised<Left>(count, out(), *a(), b(), range);
        return vectorised<Binary>(count, out(), a(), b(), range);
    }

    // a and b may be the same: they are only read.
    [[nodiscard]] RTAMT_INLINE static std::size_t over(double* __restrict out,
                                                       const double* __restrict a,
                                                       const double* __restrict b,
                                                       Range range) noexcept {
        return fill<Function::partial>(out, range,
                                       [=](std::size_t i) { return Function::of(a[i], b[i]); });
    }

    void transfer(Snapshot& /*snapshot*/) override {}

  private:
    struct Right {
        [[nodiscard]] RTAMT_INLINE static std::size_t
        over(double* __restrict out, const double* __restrict a, double b, Range range) noexcept {
            return fill<Function::partial>(out, range,
                                           [=](std::size_t i) { return Function::of(a[i], b); });
        }
    };
    struct Left {
        [[nodiscard]] RTAMT_INLINE static std::size_t
        over(double* __restrict out, double a, const double* __restrict b, Range range) noexcept {
            return fill<Function::partial>(out, range,
                                           [=](std::size_t i) { return Function::of(a, b[i]); });
        }
    };

    Same same_;
};

} // namespace rtamt::discrete
