// A loop compiled twice on x86-64: for every machine, and for those with vectors of four doubles
// (AVX2), which are found out once. Elsewhere the compiler's own vectors are all there is.
//
// Both give the same bits: contraction is off, and nothing is summed in another order.
#pragma once

#include <cstddef>
#include <utility>

#if defined(__x86_64__) && defined(__GNUC__)
#define RTAMT_WIDE [[gnu::target("avx2")]]
#define RTAMT_INLINE [[gnu::always_inline]] inline
#else
#define RTAMT_INLINE inline
#endif

namespace rtamt {

#ifdef RTAMT_WIDE

inline const bool wide_vectors = __builtin_cpu_supports("avx2") != 0;

// Calls Wide::over(arguments...) or, without wide vectors or for few values, Loop::over; both are
// to be RTAMT_INLINE.
template <class Loop, class... Arguments>
RTAMT_WIDE [[gnu::noinline]] auto widely(Arguments... arguments) noexcept {
    return Loop::over(arguments...);
}

template <class Wide, class Loop = Wide, class... Arguments>
auto vectorised(std::size_t count, Arguments... arguments) noexcept {
    constexpr std::size_t worth_a_call = 16;
    if (count >= worth_a_call && wide_vectors) return widely<Wide>(arguments...);
    return Loop::over(arguments...);
}

#else

template <class Wide, class Loop = Wide, class... Arguments>
auto vectorised(std::size_t /*count*/, Arguments... arguments) noexcept {
    return Loop::over(arguments...);
}

#endif

} // namespace rtamt
