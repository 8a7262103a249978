// The definitions of kernels.hpp, for the files that instantiate it for a domain (real.cpp and its
// neighbours).
#pragma once

#include "kernels.hpp"

#include "../program/kernel_factory.hpp"
#include "constant.hpp"
#include "pointwise.hpp"
#include "pulses.hpp"
#include "rank.hpp"
#include "running.hpp"
#include "shift.hpp"
#include "since.hpp"
#include "until.hpp"
#include "window.hpp"

namespace rtamt::dense {

namespace detail {

struct Make {
    using Pointer = std::unique_ptr<Kernel>;
    const Instruction& at;

    template <class Operation>
    [[nodiscard]] Pointer unary() const {
        return std::make_unique<Unary<Operation>>(at.lag);
    }
    template <class Operation>
    [[nodiscard]] Pointer binary() const {
        return std::make_unique<Binary<Operation>>(at.lag);
    }
    template <ValueDomain D>
    [[nodiscard]] Pointer shift() const {
        return std::make_unique<Shift<D>>(at.lag, at.n, D::of(at.x));
    }
    template <class Algebra>
    [[nodiscard]] Pointer slide() const {
        return std::make_unique<Slide<Algebra>>(at.lag, at.n);
    }
    template <class Algebra>
    [[nodiscard]] Pointer running() const {
        return std::make_unique<Running<Algebra>>(at.lag);
    }
    // The sum of a step function is no step function; that of pulses of a tick is.
    template <ValueDomain N>
    [[nodiscard]] Pointer slide_sum() const {
        return std::make_unique<Pulses<N>>(at.lag, N::of(0.0), at.n);
    }
    template <ValueDomain N>
    [[nodiscard]] Pointer run_sum() const {
        return std::make_unique<Pulses<N>>(at.lag, N::of(0.0), never);
    }
    template <ValueDomain D>
    [[nodiscard]] Pointer since() const {
        return std::make_unique<Since<D>>(at.lag);
    }
    template <ValueDomain D>
    [[nodiscard]] Pointer until() const {
        return std::make_unique<Until<D>>(at.lag, at.n);
    }
    template <ValueDomain D, bool least>
    [[nodiscard]] Pointer rank() const {
        return std::make_unique<Rank<D, least>>(at.lag, least ? D::top : D::bottom, at.n, at.x);
    }
};

} // namespace detail

template <ValueDomain D>
std::unique_ptr<Kernel> Kernels<D>::make(const Instruction& instruction, Sort sort) {
    return make_kernel<D>(instruction.opcode, sort, detail::Make{instruction});
}

template <ValueDomain D>
std::unique_ptr<Kernel> Kernels<D>::constant(Sort sort, std::int64_t lag, double x) {
    using Number = typename D::Number;
    if (sort == Sort::number) return std::make_unique<Constant<Number>>(lag, Number::of(x));
    return std::make_unique<Constant<D>>(lag, D::of(x));
}

template <ValueDomain D>
std::unique_ptr<Kernel> Kernels<D>::cross(Sort from, std::int64_t lag)
    requires(!UniformDomain<D>)
{
    if (from == Sort::number) return std::make_unique<Unary<operations::ToFormula<D>>>(lag);
    return std::make_unique<Unary<operations::ToNumber<D>>>(lag);
}

} // namespace rtamt::dense
