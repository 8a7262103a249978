#include "discrete/truth_tiles.hpp"

#include "check.hpp"

#include <random>
#include <vector>

using rtamt::discrete::transpose_tiles;
using rtamt::discrete::TruthWord;

TEST_CASE("bit c of word r becomes bit r of word c, in each tile") {
    std::mt19937_64 engine(1);
    for (const std::size_t tiles : {0U, 1U, 2U, 5U}) {
        std::vector<TruthWord> words(64 * tiles);
        for (TruthWord& word : words)
            word = engine();
        auto turned = words;
        transpose_tiles(turned.data(), tiles);
        for (std::size_t tile = 0; tile < tiles; ++tile) {
            bool right = true;
            for (std::size_t r = 0; r < 64; ++r) {
                for (std::size_t c = 0; c < 64; ++c)
                    right &=
                        ((turned[64 * tile + c] >> r) & 1U) == ((words[64 * tile + r] >> c) & 1U);
            }
            CHECK(right);
        }
        transpose_tiles(turned.data(), tiles);
        CHECK(turned == words);
    }
}
