// The operations of pointwise instructions: an operation maps values of the domain `In` to values
// of the domain `Out`. `partial` ones may return undefined values.
#pragma once

#include "algebra.hpp"
#include "domain.hpp"

namespace rtamt::operations {

// Any function of numbers.
template <class N, class Function>
struct Map {
    using In = N;
    using Out = N;
    static constexpr bool partial = Function::partial;
    template <class... Values>
    [[nodiscard]] static typename N::Value of(const Values&... operands) noexcept {
        return N::template apply<Function>(operands...);
    }
};

template <ValueDomain D>
struct Not {
    using In = D;
    using Out = D;
    static constexpr bool partial = false;
    [[nodiscard]] static typename D::Value of(const typename D::Value& a) noexcept {
        return D::neg(a);
    }
};

// `or` of MaxOf, `and` of MinOf.
template <class Algebra>
struct Connect {
    using In = typename Algebra::Domain;
    using Out = In;
    using Value = typename In::Value;
    static constexpr bool partial = false;
    [[nodiscard]] static Value of(const Value& a, const Value& b) noexcept {
        return Algebra::join(a, b);
    }
};

// A predicate: numbers in, a formula out.
template <ValueDomain D, class Comparison>
struct Test {
    using In = typename D::Number;
    using Out = D;
    using Value = typename In::Value;
    static constexpr bool partial = false;
    [[nodiscard]] static typename D::Value of(const Value& a, const Value& b) noexcept {
        if constexpr (UniformDomain<D>) {
            return D::template apply<Comparison>(a, b);
        } else {
            return D::template test<Comparison>(a, b);
        }
    }
};

// A number used as a formula, where these have different values.
template <ValueDomain D>
struct ToFormula {
    using In = typename D::Number;
    using Out = D;
    static constexpr bool partial = false;
    [[nodiscard]] static typename D::Value of(const typename In::Value& a) noexcept {
        return D::formula(a);
    }
};

// A formula used as a number.
template <ValueDomain D>
struct ToNumber {
    using In = D;
    using Out = typename D::Number;
    static constexpr bool partial = false;
    [[nodiscard]] static typename Out::Value of(const typename D::Value& a) noexcept {
        return D::number(a);
    }
};

} // namespace rtamt::operations
