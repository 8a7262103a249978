// Unbounded future over whole step functions: one pass from their end, offline only. The last value
// holds for ever, so what it gives at the last event is final.
//
// Cost: one or two comparisons an event. Memory: the result.
#pragma once

#include "../values/algebra.hpp"
#include "events.hpp"
#include "merge.hpp"

#include <cstddef>

namespace rtamt::dense {

// Removes events that change nothing.
inline void merge_equal(EventList& list) noexcept {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < list.count(); ++i) {
        if (kept != 0 && list.values()[kept - 1] == list.values()[i]) continue;
        list.times()[kept] = list.times()[i];
        list.values()[kept++] = list.values()[i];
    }
    list.resize(kept);
}

// At t, the extremum from t on: unbounded eventually (Max) and always (Min).
template <class Algebra>
[[nodiscard]] EventList scan(const Events& a) {
    EventList result;
    result.append(a);
    double extremum = Algebra::identity;
    for (std::size_t i = a.count; i-- > 0;) {
        extremum = Algebra::join(a.values[i], extremum);
        result.values()[i] = extremum;
    }
    merge_equal(result);
    return result;
}

// U = max(psi, min(phi, U of the next segment)), psi on the last one: unbounded until, from where
// both operands have begun.
[[nodiscard]] inline EventList scan_until(const Events& phi, const Events& psi) {
    EventList holds; // phi and psi on the same segments
    EventList result;
    if (phi.count == 0 || psi.count == 0) return result;
    const std::int64_t start = std::max(phi.times[0], psi.times[0]);
    Pair<double> values;
    merge(phi, psi, values, [&](std::int64_t time, const Pair<double>& now) {
        if (time < start) return;
        holds.append(time, now.a);
        result.append(time, now.b);
    });
    double until = Max::identity;
    for (std::size_t i = result.count(); i-- > 0;) {
        until = Max::join(result.values()[i], Min::join(holds.values()[i], until));
        result.values()[i] = until;
    }
    merge_equal(result);
    return result;
}

} // namespace rtamt::dense
