// The operation of an opcode, for the kernels of both time domains.
//
// A `Make` has a template for every kind of kernel: unary and binary for an operation
// (values/operations.hpp), shift, since, until and rank for a domain, slide and running for an
// algebra; each returns a `Make::Pointer`, which owns the kernel. Sums are made by slide and
// running unless it has slide_sum and run_sum, too.
#pragma once

#include "../values/algebra.hpp"
#include "../values/functions.hpp"
#include "../values/operations.hpp"
#include "number_functions.hpp"
#include "opcodes.hpp"

namespace rtamt {

namespace detail {

// A window, an operation on values that may be numbers or formulas, or null.
template <ValueDomain D, class Make>
[[nodiscard]] typename Make::Pointer make_either(Opcode opcode, const Make& make) {
    using Most = MaxOf<D>;
    using Least = MinOf<D>;
    switch (opcode) {
    case Opcode::neg:
        return make.template unary<operations::Not<D>>();
    case Opcode::min:
        return make.template binary<operations::Connect<Least>>();
    case Opcode::max:
        return make.template binary<operations::Connect<Most>>();
    case Opcode::shift:
        return make.template shift<D>();
    case Opcode::slide_max:
        return make.template slide<Most>();
    case Opcode::slide_min:
        return make.template slide<Least>();
    case Opcode::run_max:
        return make.template running<Most>();
    case Opcode::run_min:
        return make.template running<Least>();
    default:
        return nullptr;
    }
}

template <ValueDomain N, class Make>
[[nodiscard]] typename Make::Pointer make_number(Opcode opcode, const Make& make) {
    return with_function(
        opcode,
        [&]<class Function>(Function) -> typename Make::Pointer {
            using Operation = operations::Map<N, Function>;
            if constexpr (requires { Function::of(0.0, 0.0); }) {
                return make.template binary<Operation>();
            } else {
                return make.template unary<Operation>();
            }
        },
        [&]() -> typename Make::Pointer {
            constexpr bool own_sums = requires { make.template slide_sum<N>(); };
            if (opcode == Opcode::slide_sum) {
                if constexpr (own_sums) {
                    return make.template slide_sum<N>();
                } else {
                    return make.template slide<SumOf<N>>();
                }
            }
            if (opcode == Opcode::run_sum) {
                if constexpr (own_sums) {
                    return make.template run_sum<N>();
                } else {
                    return make.template running<SumOf<N>>();
                }
            }
            return make_either<N>(opcode, make);
        });
}

template <ValueDomain D, class Make>
[[nodiscard]] typename Make::Pointer make_formula(Opcode opcode, const Make& make) {
    using namespace functions;
    using operations::Test;
    switch (opcode) {
    case Opcode::holds_gt:
        return make.template binary<Test<D, HoldsGreater>>();
    case Opcode::holds_ge:
        return make.template binary<Test<D, HoldsGreaterEqual>>();
    case Opcode::holds_eq:
        return make.template binary<Test<D, HoldsEqual>>();
    case Opcode::since:
        return make.template since<D>();
    case Opcode::until:
        return make.template until<D>();
    case Opcode::rank_max:
        return make.template rank<D, false>();
    case Opcode::rank_min:
        return make.template rank<D, true>();
    default:
        return make_either<D>(opcode, make);
    }
}

} // namespace detail

// The kernel of an opcode whose value has this sort, formulas being of the domain D; null for
// inputs, constants and calls.
template <ValueDomain D, class Make>
[[nodiscard]] typename Make::Pointer make_kernel(Opcode opcode, Sort sort, const Make& make) {
    return sort == Sort::number ? detail::make_number<typename D::Number>(opcode, make)
                                : detail::make_formula<D>(opcode, make);
}

} // namespace rtamt
