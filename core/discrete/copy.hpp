// Copying and filling consecutive values, with the one-sample case of an online monitor kept out of
// the library: there the call would cost more than the copy.
#pragma once

#include <algorithm>
#include <cstddef>

namespace rtamt::discrete {

template <class Value>
void copy_values(const Value* from, std::size_t count, Value* to) noexcept {
    if (count == 1) {
        *to = *from;
    } else {
        std::copy_n(from, count, to);
    }
}

template <class Value>
void fill_values(Value* to, std::size_t count, const Value& value) noexcept {
    const Value constant = value; // which may lie among those that are written
    for (std::size_t i = 0; i < count; ++i)
        to[i] = constant;
}

} // namespace rtamt::discrete
