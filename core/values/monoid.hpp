// The monoids of sliding windows: extrema, sums and until.
//
// A monoid combines elements in the order of time and need not commute. An element is made of the
// operands' values at one slot; a result is read from the combination of all elements in a window,
// which is given as a total of the older ones and one of the newer ones. What is not `associative`,
// as sums of doubles, is combined one element at a time; `partial`: results may be undefined.
#pragma once

#include "algebra.hpp"

#include <concepts>
#include <type_traits>

namespace rtamt {

template <class M>
concept Monoid = std::is_trivially_copyable_v<typename M::Element> &&
                 requires(const typename M::Element& older, const typename M::Element& newer) {
                     typename M::Value;                          // of operands and results
                     { M::binary } -> std::convertible_to<bool>; // whether there are two operands
                     { M::associative } -> std::convertible_to<bool>;
                     { M::partial } -> std::convertible_to<bool>;
                     { M::identity } -> std::convertible_to<typename M::Element>;
                     // An element before all of a total, and one after all of it.
                     { M::prepend(older, newer) } noexcept -> std::same_as<typename M::Element>;
                     { M::append(older, newer) } noexcept -> std::same_as<typename M::Element>;
                     { M::result(older, newer) } noexcept -> std::same_as<typename M::Value>;
                     { M::result(newer) } noexcept -> std::same_as<typename M::Value>;
                 };

// The greatest or the least value in the window, or the sum of all.
template <class Algebra>
struct Joined {
    using Domain = typename Algebra::Domain;
    using Value = typename Algebra::Value;
    using Element = Value;
    static constexpr bool binary = false;
    static constexpr bool associative = Algebra::associative;
    static constexpr bool partial = Algebra::partial;
    static constexpr Element identity = Algebra::identity;

    [[nodiscard]] static constexpr Element element(const Value& a) noexcept { return a; }
    [[nodiscard]] static constexpr Element prepend(const Element& a, const Element& b) noexcept {
        return Algebra::join(a, b);
    }
    [[nodiscard]] static constexpr Element append(const Element& a, const Element& b) noexcept {
        return Algebra::join(b, a);
    }
    [[nodiscard]] static constexpr Value result(const Element& a, const Element& b) noexcept {
        return Algebra::join(b, a);
    }
    [[nodiscard]] static constexpr Value result(const Element& a) noexcept { return a; }
};

// Until over the window, oldest to newest: max(psi_0, min(phi_0, max(psi_1, min(phi_1, ...)))), the
// composition of all maps at the least value.
template <Lattice D>
struct UntilSteps {
    using Domain = D;
    using Value = typename D::Value;
    using Element = ClampOf<D>;
    static constexpr bool binary = true;
    static constexpr bool associative = true;
    static constexpr bool partial = false;
    static constexpr Element identity{};

    [[nodiscard]] static constexpr Element element(const Value& phi, const Value& psi) noexcept {
        return {psi, phi};
    }
    [[nodiscard]] static constexpr Element prepend(const Element& a, const Element& b) noexcept {
        return a.after(b);
    }
    [[nodiscard]] static constexpr Element append(const Element& a, const Element& b) noexcept {
        return a.after(b);
    }
    [[nodiscard]] static constexpr Value result(const Element& a, const Element& b) noexcept {
        return a.at(b.low);
    }
    [[nodiscard]] static constexpr Value result(const Element& a) noexcept { return a.low; }
};

static_assert(Monoid<Joined<Max>> && Monoid<UntilSteps<Real>>);

} // namespace rtamt
