// What states of early monitors are made of, each with what it must be for its monitor to continue.
//
// The bytes may be forged: sums of ticks must stay within their type, searches rely on the order of
// lists, and comparisons on numbers that are numbers.
#pragma once

#include "../program/snapshot.hpp"
#include "../values/bounds.hpp"
#include "step_map.hpp"

#include <cstddef>
#include <vector>

namespace rtamt::early::checked {

// A tick of a trace: from its start on, unless `least` is less.
inline void tick(Snapshot& snapshot, Tick& tick, Tick least = 0) {
    snapshot.item(tick);
    snapshot.require(least <= tick && tick < forever);
}

// The same, or `forever`.
inline void tick_or_forever(Snapshot& snapshot, Tick& tick, Tick least = 0) {
    snapshot.item(tick);
    snapshot.require(least <= tick && tick <= forever);
}

// A time: a tick from anywhere, not from the start of the trace.
inline void time(Snapshot& snapshot, Tick& time) {
    snapshot.item(time);
    snapshot.require(-3 * forever <= time && time <= 3 * forever);
}

// A number, perhaps infinite.
inline void number(Snapshot& snapshot, double& number) {
    snapshot.item(number);
    snapshot.require(number == number); // no NaN
}

// Two numbers, of which none need be the smaller one.
inline void numbers(Snapshot& snapshot, Bounds& bounds) {
    number(snapshot, bounds.lower);
    number(snapshot, bounds.upper);
}

// The ticks from `first` to `last`, after those that were read before, which `end` is behind.
inline void run(Snapshot& snapshot, Tick& first, Tick& last, Tick& end) {
    tick_or_forever(snapshot, first, end);
    tick_or_forever(snapshot, last, first);
    end = plus(last, 1);
}

// Items of at least `size` bytes, each transferred by a function.
template <class Item, class Transfer>
void list(Snapshot& snapshot, std::vector<Item>& items, std::size_t size,
          const Transfer& transfer) {
    std::size_t count = items.size();
    snapshot.count(count, size);
    items.resize(count);
    for (Item& item : items)
        transfer(item);
}

} // namespace rtamt::early::checked
