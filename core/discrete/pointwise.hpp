// Operations on the operands at the same instant: arithmetic, comparison, and, or, not.
//
// Cost: one pass over the block, vectorised where the operation allows it; none where no operand is
// present. A constant operand is read once. No memory.
#pragma once

#include "../values/operations.hpp"
#include "../values/real.hpp"
#include "../values/vectors.hpp"
#include "kernel.hpp"
#include "undefined.hpp"

#include <cstddef>
#include <cstdint>

namespace rtamt::discrete {

// Evaluates `function(i)` for each place of the range; returns the first whose value is undefined,
// or `defined`.
template <class Operation, class Function>
[[nodiscard]] RTAMT_INLINE std::size_t fill(typename Operation::Out::Value* __restrict out,
                                            Range range, Function&& function) noexcept {
    using D = typename Operation::Out;
    if constexpr (!Operation::partial) {
        for (std::size_t i = range.begin; i < range.end; ++i)
            out[i] = function(i);
        return Kernel::defined;
    } else {
        Undefined<D> undefined;
        for (std::size_t i = range.begin; i < range.end; ++i) {
            const typename D::Value value = function(i);
            out[i] = value;
            undefined.check(value);
        }
        return undefined.seen() ? first_undefined<D>(out, range) : Kernel::defined;
    }
}

template <class Operation>
class Unary final : public Kernel {
  public:
    using In = typename Operation::In::Value;
    using Out = typename Operation::Out::Value;
    using Kernel::Kernel;

    std::size_t run(const Block& block) noexcept override {
        const Range range = block.present(lag());
        return vectorised<Unary>(range.end - range.begin, out<Out>(), a<In>(), range);
    }

    [[nodiscard]] RTAMT_INLINE static std::size_t over(Out* __restrict out, const In* __restrict a,
                                                       Range range) noexcept {
        return fill<Operation>(out, range, [=](std::size_t i) { return Operation::of(a[i]); });
    }

    void transfer(Snapshot& /*snapshot*/) override {}
};

// Which operands are the same number at every slot.
struct Same {
    bool a = false;
    bool b = false;
};

template <class Operation>
class Binary final : public Kernel {
  public:
    using In = typename Operation::In::Value;
    using Out = typename Operation::Out::Value;

    explicit Binary(std::int64_t operand_lag, Same same = {}) noexcept
        : Kernel(operand_lag), same_(same) {}

    std::size_t run(const Block& block) noexcept override {
        const Range range = block.present(lag());
        const std::size_t count = range.end - range.begin;
        const In* a = this->a<In>();
        const In* b = this->b<In>();
        if (same_.b) return vectorised<Right>(count, out<Out>(), a, *b, range);
        if (same_.a) return vectorised<Left>(count, out<Out>(), *a, b, range);
        return vectorised<Binary>(count, out<Out>(), a, b, range);
    }

    // a and b may be the same: they are only read.
    [[nodiscard]] RTAMT_INLINE static std::size_t over(Out* __restrict out, const In* __restrict a,
                                                       const In* __restrict b,
                                                       Range range) noexcept {
        return fill<Operation>(out, range,
                               [=](std::size_t i) { return Operation::of(a[i], b[i]); });
    }

    void transfer(Snapshot& /*snapshot*/) override {}

  private:
    struct Right {
        [[nodiscard]] RTAMT_INLINE static std::size_t
        over(Out* __restrict out, const In* __restrict a, In b, Range range) noexcept {
            return fill<Operation>(out, range,
                                   [=](std::size_t i) { return Operation::of(a[i], b); });
        }
    };
    struct Left {
        [[nodiscard]] RTAMT_INLINE static std::size_t
        over(Out* __restrict out, In a, const In* __restrict b, Range range) noexcept {
            return fill<Operation>(out, range,
                                   [=](std::size_t i) { return Operation::of(a, b[i]); });
        }
    };

    Same same_;
};

} // namespace rtamt::discrete
