// Copying and filling consecutive cells, with the one-sample case of an online monitor kept out of
// the library: there the call would cost more than the copy.
#pragma once

#include <algorithm>
#include <cstddef>

namespace rtamt {

template <class Cell>
void copy_cells(const Cell* from, std::size_t count, Cell* to) noexcept {
    if (count == 1) {
        *to = *from;
    } else {
        std::copy_n(from, count, to);
    }
}

template <class Cell>
void fill_cells(Cell* to, std::size_t count, const Cell& value) noexcept {
    const Cell cell = value; // which may lie among those that are written
    for (std::size_t i = 0; i < count; ++i)
        to[i] = cell;
}

} // namespace rtamt
