// Extremum over all slots so far: unbounded once and historically.
//
// Cost: one comparison a sample. Memory: one value.
#pragma once

#include "../values/algebra.hpp"
#include "copy.hpp"
#include "kernel.hpp"

namespace rtamt::discrete {

template <class Algebra>
class Running final : public Scalar<typename Algebra::Value> {
  public:
    using Value = typename Algebra::Value;

    explicit Running(std::int64_t operand_lag) noexcept
        : Scalar<Value>(operand_lag, Algebra::identity) {}

    std::size_t run(const Block& block) noexcept override {
        const Range present = block.present(this->lag());
        const auto* __restrict a = Kernel::a<Value>();
        auto* __restrict out = Kernel::out<Value>();
        Value extremum = this->state();
        fill_values(out, present.begin, extremum);
        for (std::size_t i = present.begin; i < present.end; ++i) {
            extremum = Algebra::join(a[i], extremum);
            out[i] = extremum;
        }
        fill_values(out + present.end, block.count - present.end, extremum);
        this->state() = extremum;
        return Kernel::defined;
    }
};

} // namespace rtamt::discrete
