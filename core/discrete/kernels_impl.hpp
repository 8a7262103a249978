// The definitions of kernels.hpp, for the files that instantiate it for a domain (real.cpp and its
// neighbours).
#pragma once

#include "kernels.hpp"

#include "../values/functions.hpp"
#include "running.hpp"
#include "shift.hpp"
#include "since.hpp"
#include "until.hpp"
#include "window.hpp"

namespace rtamt::discrete {

namespace detail {

struct Setting {
    const Instruction& instruction;
    std::int64_t operand_lag;
    void* state;
    void* journal;
    Same same;
};

// A window, an operation on values that may be numbers or formulas, or null.
template <ValueDomain D>
std::unique_ptr<Kernel> make_either(const Setting& at) {
    using Value = typename D::Value;
    using Most = MaxOf<D>;
    using Least = MinOf<D>;
    const std::int64_t lag = at.operand_lag;
    const auto n = static_cast<std::size_t>(at.instruction.n);
    auto* state = static_cast<Value*>(at.state);
    auto* journal = static_cast<Value*>(at.journal);
    switch (at.instruction.opcode) {
    case Opcode::neg:
        return std::make_unique<Unary<operations::Not<D>>>(lag);
    case Opcode::min:
        return std::make_unique<Binary<operations::Connect<Least>>>(lag, at.same);
    case Opcode::max:
        return std::make_unique<Binary<operations::Connect<Most>>>(lag, at.same);
    case Opcode::shift:
        return std::make_unique<Shift<Value>>(lag, n, D::of(at.instruction.x), state, journal);
    case Opcode::slide_max:
        return std::make_unique<Slide<Most>>(lag, n, state, journal);
    case Opcode::slide_min:
        return std::make_unique<Slide<Least>>(lag, n, state, journal);
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
std::unique_ptr<Kernel> make_number(const Setting& at) {
    using namespace functions;
    using operations::Map;
    const std::int64_t lag = at.operand_lag;
    switch (at.instruction.opcode) {
    case Opcode::abs:
        return std::make_unique<Unary<Map<N, Abs>>>(lag);
    case Opcode::sqrt:
        return std::make_unique<Unary<Map<N, Sqrt>>>(lag);
    case Opcode::exp:
        return std::make_unique<Unary<Map<N, Exp>>>(lag);
    case Opcode::ln:
        return std::make_unique<Unary<Map<N, Ln>>>(lag);
    case Opcode::add:
        return std::make_unique<Binary<Map<N, Add>>>(lag, at.same);
    case Opcode::sub:
        return std::make_unique<Binary<Map<N, Sub>>>(lag, at.same);
    case Opcode::mul:
        return std::make_unique<Binary<Map<N, Mul>>>(lag, at.same);
    case Opcode::div:
        return std::make_unique<Binary<Map<N, Div>>>(lag, at.same);
    case Opcode::pow:
        return std::make_unique<Binary<Map<N, Pow>>>(lag, at.same);
    case Opcode::log:
        return std::make_unique<Binary<Map<N, Log>>>(lag, at.same);
    default:
        return make_either<N>(at);
    }
}

template <ValueDomain D>
std::unique_ptr<Kernel> make_formula(const Setting& at) {
    using namespace functions;
    using operations::Test;
    const std::int64_t lag = at.operand_lag;
    switch (at.instruction.opcode) {
    case Opcode::holds_gt:
        return std::make_unique<Binary<Test<D, HoldsGreater>>>(lag, at.same);
    case Opcode::holds_ge:
        return std::make_unique<Binary<Test<D, HoldsGreaterEqual>>>(lag, at.same);
    case Opcode::holds_eq:
        return std::make_unique<Binary<Test<D, HoldsEqual>>>(lag, at.same);
    case Opcode::since:
        return std::make_unique<Since<D>>(lag);
    case Opcode::until:
        return std::make_unique<Until<D>>(lag, static_cast<std::size_t>(at.instruction.n),
                                          static_cast<ClampOf<D>*>(at.state),
                                          static_cast<ClampOf<D>*>(at.journal));
    default:
        return make_either<D>(at);
    }
}

} // namespace detail

template <ValueDomain D>
std::size_t Kernels<D>::state_size(const Instruction& instruction, Sort sort) noexcept {
    const auto n = static_cast<std::size_t>(instruction.n);
    switch (instruction.opcode) {
    case Opcode::shift:
    case Opcode::slide_max:
    case Opcode::slide_min:
        return n * (sort == Sort::number ? sizeof(typename D::Number::Value)
                                         : sizeof(typename D::Value));
    case Opcode::until:
        return n * sizeof(ClampOf<D>);
    default:
        return 0;
    }
}

template <ValueDomain D>
std::unique_ptr<Kernel> Kernels<D>::make(const Instruction& instruction, Sort sort,
                                         std::int64_t operand_lag, void* state, void* journal,
                                         Same same) {
    const detail::Setting at{instruction, operand_lag, state, journal, same};
    return sort == Sort::number ? detail::make_number<typename D::Number>(at)
                                : detail::make_formula<D>(at);
}

template <ValueDomain D>
std::unique_ptr<Kernel> Kernels<D>::cross(Sort from, std::int64_t lag)
    requires(!UniformDomain<D>)
{
    if (from == Sort::number) return std::make_unique<Unary<operations::ToFormula<D>>>(lag);
    return std::make_unique<Unary<operations::ToNumber<D>>>(lag);
}

} // namespace rtamt::discrete
