// Unbounded since, by its recursion S(t) = max(psi(t), min(phi(t), S(t-1))), S(-1) = -inf
// (O. Maler, D. Nickovic, "Monitoring properties of analog and mixed-signal circuits", 2013).
//
// Cost: two comparisons a sample. Memory: one value.
#pragma once

#include "../values/domain.hpp"
#include "copy.hpp"
#include "kernel.hpp"

namespace rtamt::discrete {

template <ValueDomain D>
class Since final : public Scalar<typename D::Value> {
  public:
    using Value = typename D::Value;

    explicit Since(std::int64_t operand_lag) noexcept : Scalar<Value>(operand_lag, D::bottom) {}

    std::size_t run(const Block& block) noexcept override {
        const Range present = block.present(this->lag());
        const auto* phi = Kernel::a<Value>(); // may be the same as psi
        const auto* psi = Kernel::b<Value>();
        auto* __restrict out = Kernel::out<Value>();
        Value since = this->state();
        fill_values(out, present.begin, since);
        for (std::size_t i = present.begin; i < present.end; ++i) {
            since = D::join(psi[i], D::meet(phi[i], since));
            out[i] = since;
        }
        fill_values(out + present.end, block.count - present.end, since);
        this->state() = since;
        return Kernel::defined;
    }
};

} // namespace rtamt::discrete
