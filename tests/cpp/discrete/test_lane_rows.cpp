#include "discrete/lane_rows.hpp"

#include "check.hpp"

#include <vector>

using namespace rtamt;
using namespace rtamt::discrete;

TEST_CASE("rows become lanes, and lanes rows, for any number of samples") {
    for (const std::size_t count : {0U, 1U, 2U, 5U, 16U, 64U, 65U, 131U}) {
        std::vector<std::vector<double>> rows(8, std::vector<double>(count));
        std::vector<std::vector<double>> back(8, std::vector<double>(count));
        LaneRows<const double, 8> from{};
        LaneRows<double, 8> to{};
        for (std::size_t lane = 0; lane < 8; ++lane) {
            for (std::size_t i = 0; i < count; ++i)
                rows[lane][i] = static_cast<double>(100 * lane + i);
            from[lane] = rows[lane].data();
            to[lane] = back[lane].data();
        }
        std::vector<Lanes<8>::Value> values(count);
        gather<8>(from, count, values.data());
        for (std::size_t i = 0; i < count; ++i) {
            for (std::size_t lane = 0; lane < 8; ++lane)
                CHECK(values[i].lane[lane] == rows[lane][i]);
        }
        scatter<8>(values.data(), count, to);
        CHECK(back == rows);
    }
}
