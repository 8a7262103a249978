// States that somebody has changed and whose checksum is right all the same.
#pragma once

#include "programs.hpp"

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

namespace forged {

// Calls visit(state) with a word at every place of a state replaced by numbers that mislead: the
// state ends with its checksum.
template <class Visit>
void each(const std::vector<std::uint8_t>& state, Visit&& visit) {
    using Limits = std::numeric_limits<std::int64_t>;
    for (std::size_t place = 0; place + 12 <= state.size(); ++place) {
        std::uint64_t word = 0;
        std::memcpy(&word, state.data() + place, sizeof word);
        const auto half = static_cast<std::uint64_t>(Limits::max() / 2);
        const std::array<std::uint64_t, 12> numbers{
            0,
            1,
            2,
            7,
            word + 1,
            word - 1,
            half,
            half - 1,
            static_cast<std::uint64_t>(Limits::max()),
            static_cast<std::uint64_t>(Limits::min()),
            ~std::uint64_t{0},
            std::bit_cast<std::uint64_t>(std::numeric_limits<double>::quiet_NaN())};
        for (const std::uint64_t number : numbers) {
            std::vector<std::uint8_t> changed = state;
            std::memcpy(changed.data() + place, &number, sizeof number);
            visit(programs::sealed(std::move(changed)));
        }
    }
}

} // namespace forged
