#include "dense/merge.hpp"

#include "ways.hpp"

#include <algorithm>

using ways::Random;

TEST_CASE("every instant of either signal comes once with both values") {
    Random random(9);
    for (int round = 0; round < 300; ++round) {
        const auto trace = dense_oracle::random_trace(random, 2, 12);
        const auto& a = trace[0];
        const auto& b = trace[1];
        std::vector<std::int64_t> expected(a.times);
        expected.insert(expected.end(), b.times.begin(), b.times.end());
        std::ranges::sort(expected);
        expected.erase(std::ranges::unique(expected).begin(), expected.end());
        std::vector<std::int64_t> seen;
        rtamt::dense::Pair<double> values{100, 200};
        rtamt::dense::merge(a.events(0, a.size()), b.events(0, b.size()), values,
                            [&](std::int64_t time, const rtamt::dense::Pair<double>& now) {
                                seen.push_back(time);
                                CHECK(now.a == (time < a.times[0] ? 100 : at(a, time)));
                                CHECK(now.b == (time < b.times[0] ? 200 : at(b, time)));
                            });
        CHECK(seen == expected);
        CHECK((values.a == a.values.back() && values.b == b.values.back()));
    }
}
