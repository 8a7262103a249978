// The definitions of kernels.hpp, for the files that instantiate it for a domain (real.cpp and its
// neighbours).
#pragma once

#include "kernels.hpp"

#include "../program/kernel_factory.hpp"
#include "rank.hpp"
#include "running.hpp"
#include "shift.hpp"
#include "since.hpp"
#include "steady_window.hpp"
#include "truth_memory.hpp"
#include "until.hpp"
#include "window.hpp"

namespace rtamt::discrete {

namespace detail {

// Whether an instruction with a state keeps bits instead of real numbers. That of until are decided
// many at a time, which may not be.
[[nodiscard]] constexpr bool packs(const Instruction& at) noexcept {
    return at.truth && at.n >= least_packed && (!at.steady || at.opcode != Opcode::until);
}

struct Make {
    using Pointer = std::unique_ptr<Kernel>;
    const Instruction& at;
    std::int64_t lag = 0; // of the operands
    void* state = nullptr;
    void* journal = nullptr;
    Same same;

    template <class Operation>
    [[nodiscard]] Pointer unary() const {
        return std::make_unique<Unary<Operation>>(lag);
    }
    template <class Operation>
    [[nodiscard]] Pointer binary() const {
        return std::make_unique<Binary<Operation>>(lag, same);
    }
    template <ValueDomain D>
    [[nodiscard]] Pointer shift() const {
        using Value = typename D::Value;
        if constexpr (std::same_as<D, Real>) {
            if (packs(at)) return with_ring<TruthShift, TruthBits::Word>(at.x);
        }
        return with_ring<Shift<Value>, Value>(D::of(at.x));
    }
    template <class Algebra>
    [[nodiscard]] Pointer slide() const {
        using M = Joined<Algebra>;
        if constexpr (std::same_as<typename Algebra::Domain, Real> && Algebra::associative) {
            if (packs(at)) return std::make_unique<TruthWindow<Algebra>>(lag, width());
        }
        if constexpr (has_steady<M>) {
            if (is_steady()) return sliding<Sliding<M, SteadyWindow<M>>, M>();
        }
        return sliding<Sliding<M>, M>();
    }
    template <class Algebra>
    [[nodiscard]] Pointer running() const {
        return std::make_unique<Running<Algebra>>(lag, at.lag);
    }
    template <ValueDomain D>
    [[nodiscard]] Pointer since() const {
        return std::make_unique<Since<D>>(lag);
    }
    template <ValueDomain D>
    [[nodiscard]] Pointer until() const {
        using M = UntilSteps<D>;
        if constexpr (std::same_as<D, Real>) {
            if (packs(at)) return with_ring<TruthUntil, TruthBits::Word>();
        }
        if constexpr (has_steady<M>) {
            if (is_steady()) return sliding<Sliding<M, SteadyWindow<M>>, M>();
        }
        return sliding<Sliding<M>, M>();
    }

    template <ValueDomain D, bool least>
    [[nodiscard]] Pointer rank() const {
        return std::make_unique<Rank<D, least>>(lag, width(), at.x, state, journal);
    }

  private:
    // Only monitors have updates that may not take long, and they compute with real numbers.
    template <Monoid M>
    static constexpr bool has_steady =
        M::associative && std::same_as<typename M::Value, Real::Value>;

    [[nodiscard]] std::size_t width() const noexcept { return static_cast<std::size_t>(at.n); }
    [[nodiscard]] bool is_steady() const noexcept { return at.steady && at.n >= narrowest_steady; }

    template <class Kernel, Monoid M>
    [[nodiscard]] Pointer sliding() const {
        using Element = typename M::Element;
        return std::make_unique<Kernel>(lag, width(), static_cast<Element*>(state),
                                        static_cast<Element*>(journal), at.lag);
    }
    template <class Ringed, class Element, class... Arguments>
    [[nodiscard]] Pointer with_ring(const Arguments&... arguments) const {
        return std::make_unique<Ringed>(lag, width(), arguments..., static_cast<Element*>(state),
                                        static_cast<Element*>(journal));
    }
};

} // namespace detail

template <ValueDomain D>
std::size_t Kernels<D>::state_size(const Instruction& instruction, Sort sort) noexcept {
    const auto n = static_cast<std::size_t>(instruction.n);
    if constexpr (std::same_as<D, Real>) {
        if (detail::packs(instruction)) {
            const bool ring =
                instruction.opcode == Opcode::shift || instruction.opcode == Opcode::until;
            return ring ? TruthBits::words(n) * sizeof(TruthBits::Word) : 0;
        }
    }
    switch (instruction.opcode) {
    case Opcode::shift:
    case Opcode::slide_max:
    case Opcode::slide_min:
    case Opcode::slide_sum:
        return n * (sort == Sort::number ? sizeof(typename D::Number::Value)
                                         : sizeof(typename D::Value));
    case Opcode::until:
        return n * sizeof(ClampOf<D>);
    case Opcode::rank_max:
    case Opcode::rank_min:
        return n * Rank<D, true>::slot_size;
    default:
        return 0;
    }
}

template <ValueDomain D>
std::unique_ptr<Kernel> Kernels<D>::make(const Instruction& instruction, Sort sort,
                                         std::int64_t operand_lag, void* state, void* journal,
                                         Same same) {
    return make_kernel<D>(instruction.opcode, sort,
                          detail::Make{instruction, operand_lag, state, journal, same});
}

template <ValueDomain D>
std::unique_ptr<Kernel> Kernels<D>::cross(Sort from, std::int64_t lag)
    requires(!UniformDomain<D>)
{
    if (from == Sort::number) return std::make_unique<Unary<operations::ToFormula<D>>>(lag);
    return std::make_unique<Unary<operations::ToNumber<D>>>(lag);
}

} // namespace rtamt::discrete
