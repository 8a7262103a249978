// The definitions of kernels.hpp, for the files that instantiate it for a domain (real.cpp and its
// neighbours).
#pragma once

#include "kernels.hpp"

#include "../values/functions.hpp"
#include "constant.hpp"
#include "pointwise.hpp"
#include "running.hpp"
#include "shift.hpp"
#include "since.hpp"
#include "until.hpp"
#include "window.hpp"

namespace rtamt::dense {

namespace detail {

// A window, an operation on values that may be numbers or formulas, or null.
template <ValueDomain D>
std::unique_ptr<Kernel> make_either(const Instruction& at) {
    using Most = MaxOf<D>;
    using Least = MinOf<D>;
    const std::int64_t lag = at.lag;
    switch (at.opcode) {
    case Opcode::neg:
        return std::make_unique<Unary<operations::Not<D>>>(lag);
    case Opcode::min:
        return std::make_unique<Binary<operations::Connect<Least>>>(lag);
    case Opcode::max:
        return std::make_unique<Binary<operations::Connect<Most>>>(lag);
    case Opcode::shift:
        return std::make_unique<Shift<D>>(lag, at.n, D::of(at.x));
    case Opcode::slide_max:
        return std::make_unique<Slide<Most>>(lag, at.n);
    case Opcode::slide_min:
        return std::make_unique<Slide<Least>>(lag, at.n);
    case Opcode::run_max:
        return std::make_unique<Running<Most>>(lag);
    case Opcode::run_min:
        return std::make_unique<Running<Least>>(lag);
    default:
        return nullptr;
    }
}

// Arithmetic, or null.
template <ValueDomain N>
std::unique_ptr<Kernel> make_number(const Instruction& at) {
    using namespace functions;
    using operations::Map;
    const std::int64_t lag = at.lag;
    switch (at.opcode) {
    case Opcode::abs:
        return std::make_unique<Unary<Map<N, Abs>>>(lag);
    case Opcode::sqrt:
        return std::make_unique<Unary<Map<N, Sqrt>>>(lag);
    case Opcode::exp:
        return std::make_unique<Unary<Map<N, Exp>>>(lag);
    case Opcode::ln:
        return std::make_unique<Unary<Map<N, Ln>>>(lag);
    case Opcode::add:
        return std::make_unique<Binary<Map<N, Add>>>(lag);
    case Opcode::sub:
        return std::make_unique<Binary<Map<N, Sub>>>(lag);
    case Opcode::mul:
        return std::make_unique<Binary<Map<N, Mul>>>(lag);
    case Opcode::div:
        return std::make_unique<Binary<Map<N, Div>>>(lag);
    case Opcode::pow:
        return std::make_unique<Binary<Map<N, Pow>>>(lag);
    case Opcode::log:
        return std::make_unique<Binary<Map<N, Log>>>(lag);
    default:
        return make_either<N>(at);
    }
}

template <ValueDomain D>
std::unique_ptr<Kernel> make_formula(const Instruction& at) {
    using namespace functions;
    using operations::Test;
    const std::int64_t lag = at.lag;
    switch (at.opcode) {
    case Opcode::holds_gt:
        return std::make_unique<Binary<Test<D, HoldsGreater>>>(lag);
    case Opcode::holds_ge:
        return std::make_unique<Binary<Test<D, HoldsGreaterEqual>>>(lag);
    case Opcode::holds_eq:
        return std::make_unique<Binary<Test<D, HoldsEqual>>>(lag);
    case Opcode::since:
        return std::make_unique<Since<D>>(lag);
    case Opcode::until:
        return std::make_unique<Until<D>>(lag, at.n);
    default:
        return make_either<D>(at);
    }
}

} // namespace detail

template <ValueDomain D>
std::unique_ptr<Kernel> Kernels<D>::make(const Instruction& instruction, Sort sort) {
    return sort == Sort::number ? detail::make_number<typename D::Number>(instruction)
                                : detail::make_formula<D>(instruction);
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
