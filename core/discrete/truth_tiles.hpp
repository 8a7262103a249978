// Tiles of 64 truth values of each of 64 traces: a word a trace, or a word a slot.
//
// Cost: six passes of two operations over the words of a tile, in vectors: a seventh of an
// operation a value.
#pragma once

#include "../values/vectors.hpp"
#include "truth_words.hpp"

#include <cstddef>

namespace rtamt::discrete {

// Exchanges bit c of word r with bit r of word c, for the 64 words of each tile.
struct TransposeTiles {
    RTAMT_INLINE static void over(TruthWord* words, std::size_t tiles) noexcept {
        for (std::size_t tile = 0; tile < tiles; ++tile, words += truth_word_bits) {
            exchange<32>(words);
            exchange<16>(words);
            exchange<8>(words);
            exchange<4>(words);
            exchange<2>(words);
            exchange<1>(words);
        }
    }

  private:
    // Exchanges the upper half of each square of 2 * size with its lower half, across.
    template <std::size_t size>
    RTAMT_INLINE static void exchange(TruthWord* words) noexcept {
        constexpr TruthWord lower = ~TruthWord{0} / ((TruthWord{1} << size) + 1);
        for (std::size_t square = 0; square < truth_word_bits; square += 2 * size) {
            for (std::size_t i = square; i < square + size; ++i) {
                const TruthWord differing = ((words[i] >> size) ^ words[i + size]) & lower;
                words[i + size] ^= differing;
                words[i] ^= differing << size;
            }
        }
    }
};

inline void transpose_tiles(TruthWord* words, std::size_t tiles) noexcept {
    vectorised<TransposeTiles>(tiles * truth_word_bits, words, tiles);
}

} // namespace rtamt::discrete
