// The events of two step functions in one sequence, with the values of both at each.
//
// Cost: O(1) an event, without a branch on which comes first: on traces that interleave at random
// a mispredicted branch would cost more than all the rest.
#pragma once

#include "events.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace rtamt::dense {

// The values of two step functions at the frontier.
template <class Value>
struct Pair {
    Value a{};
    Value b{};
};

// Calls visit(time, values) once for each instant at which one of them has an event.
template <class Value, class Visit>
void merge(const BasicEvents<Value>& a, const BasicEvents<Value>& b, Pair<Value>& values,
           Visit&& visit) {
    Pair<Value> now = values;
    std::size_t i = 0;
    std::size_t j = 0;
    while (i < a.count && j < b.count) {
        const std::int64_t left = a.times[i];
        const std::int64_t right = b.times[j];
        const std::int64_t time = std::min(left, right);
        now.a = left == time ? a.values[i] : now.a;
        now.b = right == time ? b.values[j] : now.b;
        i += left == time ? 1 : 0;
        j += right == time ? 1 : 0;
        visit(time, now);
    }
    for (; i < a.count; ++i) {
        now.a = a.values[i];
        visit(a.times[i], now);
    }
    for (; j < b.count; ++j) {
        now.b = b.values[j];
        visit(b.times[j], now);
    }
    values = now;
}

} // namespace rtamt::dense
