// Extremum over all slots so far: unbounded once and historically; and their sum.
//
// Cost: one operation a sample. Memory: one value.
#pragma once

#include "../values/algebra.hpp"
#include "copy.hpp"
#include "kernel.hpp"
#include "undefined.hpp"

namespace rtamt::discrete {

template <class Algebra>
class Running final : public Scalar<typename Algebra::Value> {
  public:
    using Value = typename Algebra::Value;

    // `lag`: of the result, as in two_stack.hpp.
    explicit Running(std::int64_t operand_lag, std::int64_t lag = 0) noexcept
        : Scalar<Value>(operand_lag, Algebra::identity), lag_(lag) {}

    std::size_t run(const Block& block) noexcept override {
        const Range present = block.present(this->lag());
        const auto* __restrict a = Kernel::a<Value>();
        auto* __restrict out = Kernel::out<Value>();
        Value total = this->state();
        fill_values(out, present.begin, total);
        for (std::size_t i = present.begin; i < present.end; ++i) {
            total = Algebra::join(a[i], total);
            out[i] = total;
        }
        fill_values(out + present.end, block.count - present.end, total);
        this->state() = total;
        if constexpr (Algebra::partial) {
            return first_undefined<typename Algebra::Domain>(out, block.until_end(present, lag_));
        }
        return Kernel::defined;
    }

  private:
    std::int64_t lag_;
};

} // namespace rtamt::discrete
