// The concept of a value domain: what the registers of a program hold, and how values combine.
//
// Kernels, monoids and executors are templates over a domain. A formula has a value of the domain
// itself; the numbers that its predicates compare have values of `D::Number`, a domain with
// arithmetic. Where both are the same domain, a value serves as either.
//
//     domain      a value is                              numbers
//     Real        a robustness                            Real
//     Interval    bounds of a robustness                  Interval
//     Lanes<n>    a robustness of n traces                Lanes<n>
//     Truth       a truth value of 64 traces              Lanes<64>
//
// Values are lattice elements: `join` and `meet` are max and min for a single robustness, and are
// taken componentwise otherwise. An undefined value is one that no operation may return: NaN in any
// component. Domains without NaN have none.
#pragma once

#include <concepts>
#include <type_traits>

namespace rtamt {

// What minima and maxima need of a domain.
template <class D>
concept Lattice = std::is_trivially_copyable_v<typename D::Value> &&
                  requires(const typename D::Value& a, const typename D::Value& b) {
                      // The least and the greatest value: false and true.
                      { D::bottom } -> std::convertible_to<typename D::Value>;
                      { D::top } -> std::convertible_to<typename D::Value>;
                      { D::join(a, b) } noexcept -> std::same_as<typename D::Value>;
                      { D::meet(a, b) } noexcept -> std::same_as<typename D::Value>;
                  };

template <class D>
concept ValueDomain = Lattice<D> && std::equality_comparable<typename D::Value> &&
                      std::default_initializable<typename D::Value> &&
                      alignof(typename D::Value) == alignof(double) &&
                      requires(const typename D::Value& a, double x) {
                          // Whether any two values are ordered, so that of two the join is one.
                          { D::total } -> std::convertible_to<bool>;
                          { D::neg(a) } noexcept -> std::same_as<typename D::Value>;
                          { D::undefined(a) } noexcept -> std::same_as<bool>;
                          // The value of a constant.
                          { D::of(x) } noexcept -> std::same_as<typename D::Value>;
                          typename D::Number;
                      };

// Whether numbers and formulas have the same values.
template <class D>
concept UniformDomain = ValueDomain<D> && std::same_as<typename D::Number, D>;

} // namespace rtamt
