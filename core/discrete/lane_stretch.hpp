// The loops of two_stack.hpp for eight traces at once.
//
// The lanes do not depend on each other, so that no grouping is needed to hide the latency of the
// comparisons. The totals stay in vector registers from one slot to the next: of four doubles where
// there are such (AVX2), of two elsewhere.
#pragma once

#include "../values/lanes.hpp"
#include "../values/vectors.hpp"
#include "two_stack.hpp"

#include <concepts>
#include <cstddef>
#include <cstring>
#include <utility>

#if defined(__GNUC__)

namespace rtamt::discrete {

// The lattice of `m` lanes in a vector.
template <std::size_t m>
struct Pack {
    using Vector [[gnu::vector_size(m * sizeof(double))]] = double;
    struct Value { // returned in memory where it is not inlined, whatever vectors there are
        Vector lanes;
    };
    static constexpr Value bottom{Vector{} + Real::bottom};
    static constexpr Value top{Vector{} + Real::top};
    [[nodiscard]] RTAMT_INLINE static constexpr Value join(const Value& a,
                                                           const Value& b) noexcept {
        return {a.lanes > b.lanes ? a.lanes : b.lanes};
    }
    [[nodiscard]] RTAMT_INLINE static constexpr Value meet(const Value& a,
                                                           const Value& b) noexcept {
        return {a.lanes < b.lanes ? a.lanes : b.lanes};
    }
};

// The same monoid over another domain.
template <class M, Lattice D>
struct Over;
template <Lattice From, Lattice D>
struct Over<Joined<MaxOf<From>>, D> {
    using M = Joined<MaxOf<D>>;
};
template <Lattice From, Lattice D>
struct Over<Joined<MinOf<From>>, D> {
    using M = Joined<MinOf<D>>;
};
template <Lattice From, Lattice D>
struct Over<UntilSteps<From>, D> {
    using M = UntilSteps<D>;
};

// The loops of a monoid over values of `n` lanes, in vectors of `m` lanes.
template <Monoid M, std::size_t n, std::size_t m>
class LaneLoops {
    using Element = typename M::Element;
    using Value = typename M::Value;
    using Parts = std::make_index_sequence<n / m>;
    using Few = typename Over<M, Pack<m>>::M;
    using Part = typename Few::Element;
    using PartValue = typename Few::Value;

  public:
    struct Flip {
        RTAMT_INLINE static void over(Element* ring, std::size_t width) noexcept {
            over(ring, width, Parts{});
        }

      private:
        template <std::size_t... p>
        RTAMT_INLINE static void over(Element* ring, std::size_t width,
                                      std::index_sequence<p...> /*parts*/) noexcept {
            Part tails[] = {((void)p, Few::identity)...};
            for (std::size_t i = width; i > 0; --i)
                (store(tails[p] = Few::prepend(load(ring[i - 1], p * m), tails[p]), ring[i - 1],
                       p * m),
                 ...);
        }
    };

    // `sliding`: whether the stretch before is still in the window.
    template <bool sliding>
    struct Push {
        RTAMT_INLINE static Element over(Operands<M> in, Element* cells, Element back, Value* out,
                                         std::size_t count) noexcept {
            over(in, cells, back, out, count, Parts{});
            return back;
        }

      private:
        template <std::size_t... p>
        RTAMT_INLINE static void over(Operands<M> in, Element* cells, Element& back, Value* out,
                                      std::size_t count,
                                      std::index_sequence<p...> /*parts*/) noexcept {
            Part totals[] = {load(back, p * m)...};
            for (std::size_t i = 0; i < count; ++i)
                (step(in, cells, totals[p], out, i, p * m), ...);
            (store(totals[p], back, p * m), ...);
        }
        RTAMT_INLINE static void step(Operands<M> in, Element* cells, Part& total, Value* out,
                                      std::size_t i, std::size_t at) noexcept {
            const Part here = element(in, i, at);
            total = Few::append(total, here);
            if constexpr (sliding) {
                store(Few::result(load(cells[i + 1], at), total), out[i], at);
            } else {
                store(Few::result(total), out[i], at);
            }
            store(here, cells[i], at);
        }
    };

  private:
    RTAMT_INLINE static Part element(const Operands<M>& in, std::size_t i,
                                     std::size_t at) noexcept {
        if constexpr (M::binary) {
            return Few::element(load(in.a[i], at), load(in.b[i], at));
        } else {
            return Few::element(load(in.a[i], at));
        }
    }

    // The lanes from `at` on.
    RTAMT_INLINE static PartValue load(const Value& all, std::size_t at) noexcept {
        PartValue some;
        std::memcpy(&some.lanes, all.lane.data() + at, sizeof some.lanes);
        return some;
    }
    RTAMT_INLINE static auto load(const ClampOf<typename M::Domain>& all, std::size_t at) noexcept {
        return ClampOf<Pack<m>>{load(all.low, at), load(all.high, at)};
    }
    RTAMT_INLINE static void store(const PartValue& some, Value& all, std::size_t at) noexcept {
        const auto lanes = some.lanes;
        std::memcpy(all.lane.data() + at, &lanes, sizeof lanes);
    }
    RTAMT_INLINE static void store(const ClampOf<Pack<m>>& some, ClampOf<typename M::Domain>& all,
                                   std::size_t at) noexcept {
        store(some.low, all.low, at);
        store(some.high, all.high, at);
    }
};

template <Monoid M>
    requires(M::associative && std::same_as<typename M::Domain, Lanes<8>>)
struct Stretch<M> {
    using Element = typename M::Element;
    using Value = typename M::Value;
    static constexpr std::size_t lanes = 8;
    using Wide = LaneLoops<M, lanes, 4>;
    using Loops = LaneLoops<M, lanes, 2>;

    static void flip(Element* ring, std::size_t width) noexcept {
        vectorised<typename Wide::Flip, typename Loops::Flip>(lanes * width, ring, width);
    }
    [[nodiscard]] static Element grow(Operands<M> in, Element* cells, Element back, Value* out,
                                      std::size_t count) noexcept {
        return push<false>(in, cells, back, out, count);
    }
    [[nodiscard]] static Element slide(Operands<M> in, Element* cells, Element back, Value* out,
                                       std::size_t count) noexcept {
        return push<true>(in, cells, back, out, count);
    }

  private:
    template <bool sliding>
    static Element push(Operands<M> in, Element* cells, Element back, Value* out,
                        std::size_t count) noexcept {
        return vectorised<typename Wide::template Push<sliding>,
                          typename Loops::template Push<sliding>>(lanes * count, in, cells, back,
                                                                  out, count);
    }
};

} // namespace rtamt::discrete

#endif
