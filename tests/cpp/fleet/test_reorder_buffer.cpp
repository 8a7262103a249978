#include "fleet/reorder_buffer.hpp"

#include "check.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <vector>

namespace {

using rtamt::fleet::Batch;
using rtamt::fleet::KeyKind;
using rtamt::fleet::Rejected;
using rtamt::fleet::ReorderBuffer;

struct Sample {
    std::int64_t key;
    double time;
    double value;
};

constexpr double infinity = std::numeric_limits<double>::infinity();

ReorderBuffer buffer(std::optional<double> lateness, std::size_t filled = 0) {
    return ReorderBuffer({"x"}, {lateness, 3, 1.0, 0.1, filled});
}

std::optional<Rejected> offer(ReorderBuffer& reorder, const std::vector<Sample>& samples,
                              std::vector<std::uint8_t>& late) {
    std::vector<std::int64_t> keys;
    std::vector<double> times;
    std::vector<double> values;
    for (const Sample& sample : samples) {
        keys.push_back(sample.key);
        times.push_back(sample.time);
        values.push_back(sample.value);
    }
    late.assign(samples.size(), 0);
    const double* const columns[] = {values.data()};
    return reorder.offer(Batch{{KeyKind::integer, keys, {}}, times.data(), columns}, late.data());
}

// What leaves with these samples, which are not rejected.
std::vector<Sample> left(ReorderBuffer& reorder, const std::vector<Sample>& samples) {
    std::vector<std::uint8_t> late;
    CHECK(!offer(reorder, samples, late));
    std::vector<Sample> found;
    const ReorderBuffer::Ready& ready = reorder.ready();
    for (std::size_t i = 0; i < ready.size(); ++i) {
        const auto place = static_cast<std::size_t>(ready.places[i]);
        found.push_back({samples[place].key, ready.times[i], ready.columns[0][i]});
        if (ready.own[i] != 0) CHECK(samples[place].time == ready.times[i]);
    }
    reorder.accept();
    return found;
}

} // namespace

TEST_CASE("samples leave in the order of their times, each once, whatever the batches are") {
    unsigned seed = 5;
    const auto random = [&](unsigned most) {
        seed = seed * 1664525U + 1013904223U;
        return (seed >> 8U) % most;
    };
    for (int round = 0; round < 50; ++round) {
        const auto lateness = static_cast<double>(random(6));
        ReorderBuffer reorder = buffer(lateness);
        std::map<std::int64_t, double> newest;
        std::map<std::int64_t, std::vector<double>> expected;
        std::map<std::int64_t, std::vector<double>> found;
        std::uint64_t late = 0;
        for (int batch = 0; batch < 10; ++batch) {
            std::vector<Sample> samples;
            for (unsigned i = 0; i < 1 + random(9); ++i) {
                const std::int64_t key = random(3);
                const double time = batch + static_cast<double>(random(8));
                samples.push_back({key, time, 2 * time});
                auto& times = expected[key];
                const bool known = newest.contains(key);
                if ((known && time < newest[key] - lateness) ||
                    std::ranges::find(times, time) != times.end()) {
                    ++late;
                    continue;
                }
                newest[key] = known ? std::max(newest[key], time) : time;
                times.push_back(time);
            }
            if (random(2) == 0) { // what is withdrawn has changed nothing
                const auto before = reorder.snapshot();
                std::vector<std::uint8_t> flags;
                CHECK(!offer(reorder, samples, flags));
                reorder.withdraw();
                CHECK(reorder.snapshot() == before);
            }
            for (const Sample& sample : left(reorder, samples)) {
                CHECK(sample.value == 2 * sample.time);
                found[sample.key].push_back(sample.time);
            }
            if (random(3) == 0) {
                const auto state = reorder.snapshot();
                reorder = ReorderBuffer::restore({"x"}, {lateness, 3, 1.0, 0.1, 0}, state);
                CHECK(reorder.snapshot() == state);
            }
        }
        CHECK(!reorder.advance(infinity));
        const ReorderBuffer::Ready& rest = reorder.ready();
        for (std::size_t i = 0; i < rest.size(); ++i) {
            const auto place = static_cast<std::size_t>(rest.places[i]);
            found[static_cast<std::int64_t>(reorder.keys().integers()[place])].push_back(
                rest.times[i]);
        }
        reorder.accept();
        CHECK(reorder.waiting() == 0);
        CHECK(reorder.late() == late);
        for (auto& [key, times] : expected)
            std::ranges::sort(times);
        CHECK(found == expected);
    }
}

TEST_CASE("without lateness a sample that is not the newest is rejected") {
    ReorderBuffer reorder = buffer(std::nullopt);
    CHECK(left(reorder, {{1, 0.0, 1.0}, {1, 5.0, 1.0}}).size() == 2);
    std::vector<std::uint8_t> late;
    const auto wrong = offer(reorder, {{2, 0.0, 1.0}, {1, 5.0, 1.0}}, late);
    CHECK(wrong->index == 1);
    CHECK(wrong->reason == Rejected::Reason::time);
    CHECK(wrong->last == 5.0);
    CHECK(reorder.size() == 1);
}

TEST_CASE("a gap of whole periods is filled with the last value") {
    ReorderBuffer reorder = buffer(std::nullopt, 3);
    CHECK(left(reorder, {{1, 0.0, 7.0}}).size() == 1);
    const auto found = left(reorder, {{1, 3.0, 8.0}, {1, 4.5, 9.0}});
    std::vector<double> times;
    std::vector<double> values;
    for (const Sample& sample : found) {
        times.push_back(sample.time);
        values.push_back(sample.value);
    }
    CHECK(times == std::vector{1.0, 2.0, 3.0, 4.5});
    CHECK(values == std::vector{7.0, 7.0, 8.0, 9.0});
    std::vector<std::uint8_t> late;
    const auto before = reorder.snapshot();
    CHECK(offer(reorder, {{1, 9.5, 1.0}}, late)->reason == Rejected::Reason::gap);
    CHECK(reorder.snapshot() == before);
}

TEST_CASE("keys are dropped with what waits") {
    ReorderBuffer reorder = buffer(10.0);
    CHECK(left(reorder, {{1, 0.0, 1.0}, {2, 1.0, 1.0}, {3, 2.0, 1.0}}).empty());
    std::vector<std::uint8_t> late;
    CHECK(offer(reorder, {{4, 0.0, 1.0}}, late)->reason == Rejected::Reason::full);
    CHECK(reorder.stale(1.5).size() == 2);
    const std::vector<std::int64_t> keys{1, 3, 1};
    CHECK(!reorder.drop({KeyKind::integer, keys, {}}));
    CHECK(reorder.size() == 1);
    CHECK(reorder.waiting() == 1);
    CHECK(reorder.drop({KeyKind::integer, keys, {}}) == 0U);
    CHECK(left(reorder, {{2, 11.0, 5.0}}).front().time == 1.0);
}
