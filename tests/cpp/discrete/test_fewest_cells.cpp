#include "discrete/fewest_cells.hpp"

#include "check.hpp"
#include "oracle.hpp"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <set>
#include <vector>

using rtamt::discrete::CellRange;
using rtamt::discrete::FewestCells;

namespace {

using Set = std::set<std::int64_t>;

std::vector<CellRange> ranges_of(const Set& cells) {
    std::vector<CellRange> ranges;
    for (const std::int64_t cell : cells) {
        if (ranges.empty() || ranges.back().end != cell) ranges.push_back({cell, cell});
        ++ranges.back().end;
    }
    return ranges;
}

std::int64_t count_in(const Set& cells, std::int64_t first, std::int64_t last) {
    return std::distance(cells.lower_bound(first), cells.upper_bound(last));
}

} // namespace

TEST_CASE("every window has what it needs, and no cell that was taken can be left out") {
    oracle::Random random(7);
    for (int round = 0; round < 300; ++round) {
        const std::int64_t before = random.between(-6, 4);
        const std::int64_t after = before + random.between(0, 7);
        const std::int64_t need = random.between(1, after - before + 1);
        Set found;
        for (std::int64_t cell = -9; cell < 45; ++cell) {
            if (random.chance(67)) found.insert(cell);
        }
        Set asked;
        for (std::int64_t k = 0; k < 31; ++k) {
            if (count_in(found, k + before, k + after) >= need && random.chance(80))
                asked.insert(k);
        }
        const auto ranges =
            FewestCells(ranges_of(asked), ranges_of(found), before, after, need).taken();
        Set outside;
        Set taken;
        std::ranges::copy_if(found, std::inserter(outside, outside.end()),
                             [](std::int64_t cell) { return cell < 0; });
        for (const CellRange& range : ranges) {
            for (std::int64_t cell = range.begin; cell < range.end; ++cell)
                taken.insert(cell);
        }
        CHECK(std::ranges::includes(found, taken));
        const auto enough = [&](Set cells) {
            cells.insert(outside.begin(), outside.end());
            return std::ranges::all_of(asked, [&](std::int64_t k) {
                return count_in(cells, k + before, k + after) >= need;
            });
        };
        CHECK(enough(taken));
        for (const std::int64_t cell : taken) {
            Set fewer = taken;
            fewer.erase(cell);
            CHECK_FALSE(enough(fewer));
        }
    }
}

TEST_CASE("windows take the cells furthest to the right") {
    const std::vector<CellRange> asked{{0, 6}};
    const std::vector<CellRange> found{{0, 9}};
    const std::vector<CellRange> expected{{2, 4}, {6, 8}};
    CHECK((FewestCells(asked, found, 0, 3, 2).taken() == expected));
}

TEST_CASE("nothing is taken where nothing is asked") {
    CHECK(FewestCells({}, {}, 0, 3, 2).taken().empty());
}
