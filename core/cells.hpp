// Copying and filling consecutive cells, with the one-sample case of an online monitor kept out of
// the library: there the call would cost more than the copy.
#pragma once

#include <algorithm>
#include <cstddef>

namespace rtamt {

inline void copy_cells(const double* from, std::size_t count, double* to) noexcept {
    if (count == 1) {
        *to = *from;
    } else {
        std::copy_n(from, count, to);
    }
}

inline void fill_cells(double* to, std::size_t count, double value) noexcept {
    for (std::size_t i = 0; i < count; ++i)
        to[i] = value;
}

} // namespace rtamt
