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
template <class Value>
void merge_equal(BasicEventList<Value>& list) noexcept {
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
[[nodiscard]] auto scan(const BasicEvents<typename Algebra::Value>& a) {
    BasicEventList<typename Algebra::Value> result;
    result.append(a);
    auto extremum = Algebra::identity;
    for (std::size_t i = a.count; i-- > 0;) {
        extremum = Algebra::join(a.values[i], extremum);
        result.values()[i] = extremum;
    }
    merge_equal(result);
    return result;
}

// U = max(psi, min(phi, U of the next segment)), psi on the last one: unbounded until, from where
// both operands have begun.
template <ValueDomain D>
[[nodiscard]] BasicEventList<typename D::Value>
scan_until(const BasicEvents<typename D::Value>& phi, const BasicEvents<typename D::Value>& psi) {
    using Value = typename D::Value;
    BasicEventList<Value> holds; // phi and psi on the same segments
    BasicEventList<Value> result;
    if (phi.count == 0 || psi.count == 0) return result;
    const std::int64_t start = std::max(phi.times[0], psi.times[0]);
    Pair<Value> values;
    merge(phi, psi, values, [&](std::int64_t time, const Pair<Value>& now) {
        if (time < start) return;
        holds.append(time, now.a);
        result.append(time, now.b);
    });
    auto until = D::bottom;
    for (std::size_t i = result.count(); i-- > 0;) {
        until = D::join(result.values()[i], D::meet(holds.values()[i], until));
        result.values()[i] = until;
    }
    merge_equal(result);
    return result;
}

} // namespace rtamt::dense
