#include "early/zone_engine.hpp"

#include "early/bound_changes.hpp"
#include "early/bounds_at_start.hpp"
#include "program/snapshot.hpp"

#include "check.hpp"
#include "oracle.hpp"

#include <array>
#include <cmath>
#include <optional>

using namespace early_oracle;
using rtamt::early::BoundChange;
using rtamt::early::BoundChanges;
using rtamt::early::BoundsAtStart;
using rtamt::early::BoundsEngine;
using rtamt::early::Item;
using rtamt::early::ZoneEngine;
using Row = std::array<Bounds, 2>;

namespace {

constexpr Tick long_enough = 1000; // ticks a node
constexpr Tick beyond = 12;        // ticks behind the newest that are compared

// hold until[0, b] goal, as the compiler writes it.
Graph until_graph(Random& random, Tick b) {
    Graph graph = random_graph(random, 0, false);
    graph.nodes.push_back({Kind::until, 0, 3, 0, 0, forever, {}});
    graph.nodes.push_back({Kind::greatest, 3, rtamt::early::none, 0, b, b, {}});
    graph.nodes.push_back({Kind::both, 6, 8, 0, 0, b, {}});
    graph.nodes.push_back({Kind::greatest, 11, rtamt::early::none, -2, -1, b, {}});
    graph.check();
    return graph;
}

// Both engines, over the same samples.
struct Both {
    Both(const Graph& graph, std::vector<std::uint32_t> asked, const Bounds& range)
        : outputs(std::move(asked)), items{{Item::Kind::value, false, outputs[0]}},
          zone(ZoneEngine::of(graph, outputs, items, std::array{range, range}, long_enough)),
          delta(graph, {range, range}, BoundsEngine::Arrival::rows), start(items, delta),
          changes(outputs.size()) {}

    std::vector<std::uint32_t> outputs;
    std::vector<Item> items;
    std::optional<ZoneEngine> zone;
    BoundsEngine delta;
    BoundsAtStart start;
    std::vector<BoundChanges> changes;
    Tick newest = -1;

    void row(Tick t, const Row& values) {
        REQUIRE(!zone->row(t, std::span<const Bounds>(values)));
        REQUIRE(!delta.row(t, std::span<const Bounds>(values)));
        for (std::size_t k = 0; k < outputs.size(); ++k)
            changes[k].collect(delta, outputs[k], newest, t);
        start.read(delta);
        newest = t;
    }

    [[nodiscard]] Tick held(std::size_t k) const {
        return std::max<Tick>(0, newest - delta.horizon(outputs[k]));
    }

    void compare() const {
        REQUIRE(zone->at_start() == start.value());
        for (std::size_t k = 0; k < outputs.size(); ++k) {
            for (Tick t = held(k); t <= newest + beyond; ++t)
                REQUIRE(zone->at(k, t) == delta.at(outputs[k], t));
            const auto all = zone->all_from(k, 0); // nothing was dropped
            REQUIRE(std::ssize(all) == newest + 1);
            for (Tick t = 0; t <= newest; ++t)
                REQUIRE(all[static_cast<std::size_t>(t)] == delta.at(outputs[k], t));
        }
    }

    void compare_changes() const {
        for (std::size_t k = 0; k < outputs.size(); ++k) {
            const auto found = zone->changes(k);
            const auto expected = changes[k].runs(delta, outputs[k]);
            REQUIRE(found.size() == expected.size());
            for (std::size_t i = 0; i < found.size(); ++i) {
                REQUIRE(found[i].l == expected[i].l);
                REQUIRE(found[i].r == expected[i].r);
                REQUIRE(found[i].bounds == expected[i].bounds);
            }
        }
    }

    void compare_end() const {
        const ZoneEngine ended = zone->ended();
        const auto expected = delta.ended(outputs, newest + 1);
        REQUIRE(ended.at_start() == start.ended(delta, newest + 1));
        for (std::size_t k = 0; k < outputs.size(); ++k) {
            const auto found = ended.all_from(k, held(k));
            REQUIRE(std::ssize(found) == newest + 1 - held(k));
            for (Tick t = held(k); t <= newest; ++t) {
                REQUIRE(found[static_cast<std::size_t>(t - held(k))] ==
                        expected[k].bounds[static_cast<std::size_t>(t - expected[k].first)]);
            }
        }
    }

    void compare_supposed(std::span<const BoundsEngine::Supposition> later) {
        const ZoneEngine found = zone->supposed(later);
        REQUIRE(!delta.suppose(later));
        BoundsAtStart supposed = start;
        supposed.read(delta);
        REQUIRE(found.at_start() == supposed.value());
        for (std::size_t k = 0; k < outputs.size(); ++k) {
            for (Tick t = held(k); t <= newest + beyond; ++t)
                REQUIRE(found.at(k, t) == delta.at(outputs[k], t));
        }
        delta.revert();
    }

    void restore() {
        rtamt::Snapshot written;
        zone->transfer(written);
        rtamt::Snapshot read(written.bytes());
        zone->transfer(read);
        read.end();
    }
};

Row random_row(Random& random, const Bounds& range) {
    Row row{};
    for (Bounds& each : row) {
        const double a = random.number(0);
        const double b = random.chance(50) ? a : random.number(5);
        each = {std::max(std::min(a, b), range.lower), std::min(std::max(a, b), range.upper)};
        if (random.chance(15) || each.lower > each.upper) each = range;
    }
    return row;
}

// Whether there was something to compare.
bool compared(Random& random, const Graph& graph, std::vector<std::uint32_t> outputs) {
    const Bounds range = random.chance(50) ? Bounds{-12, 12} : rtamt::bounds::anything;
    Both both(graph, std::move(outputs), range);
    if (!both.zone) return false;
    both.compare();
    Tick t = 0;
    for (int sample = 0; sample < 16; ++sample) {
        both.row(t, random_row(random, range));
        both.compare();
        both.compare_changes();
        if (random.chance(20)) both.compare_end();
        if (random.chance(20)) {
            std::vector<BoundsEngine::Supposition> later;
            const Tick count = random.between(0, 4);
            for (Tick i = 1; i <= count + 1; ++i) {
                const Row row = random_row(random, range);
                const Tick last = i > count ? forever : t + i;
                later.push_back({t + i, last, {row.begin(), row.end()}});
            }
            both.compare_supposed(later);
            both.compare();
        }
        if (random.chance(20)) both.restore();
        t += random.chance(80) ? 1 : random.chance(80) ? random.between(2, 9) : 200;
    }
    return true;
}

} // namespace

TEST_CASE(
    "after every row, with gaps, at the end and supposed, both engines give the same bounds") {
    int count = 0;
    for (std::uint32_t seed = 0; seed < 1200; ++seed) {
        CAPTURE(seed);
        Random random(seed);
        const Graph graph = random_graph(random, static_cast<int>(random.between(1, 5)), false);
        const auto last = static_cast<std::uint32_t>(2 * graph.nodes.size() - 2);
        const std::uint32_t negated = random.chance(50) ? 1 : 0;
        count += compared(random, graph, {last + negated, pick(random, graph.nodes.size())});
    }
    CHECK(count > 250);
}

TEST_CASE("both engines give the same bounds of until") {
    for (std::uint32_t seed = 0; seed < 60; ++seed) {
        CAPTURE(seed);
        Random random(seed);
        REQUIRE(compared(random, until_graph(random, random.between(0, 6)), {10, 12}));
    }
}

TEST_CASE("a row without a value changes nothing") {
    Random random(3);
    Graph graph = random_graph(random, 0, false); // node 2 is the difference of both inputs
    graph.nodes.push_back({Kind::least, 4, rtamt::early::none, 0, 2, 2, {}});
    Both both(graph, {6}, rtamt::bounds::anything);
    const std::array<double, 2> first{1.0, 2.0};
    const std::array<double, 2> wrong{rtamt::infinity, rtamt::infinity};
    REQUIRE(!both.zone->row(0, std::span<const double>(first)));
    const Bounds before = both.zone->at(0, 0);
    const auto failure = both.zone->row(1, std::span<const double>(wrong));
    REQUIRE(failure);
    CHECK(failure->node == 2);
    CHECK(failure->step == 2);
    CHECK(failure->tick == 1);
    CHECK(both.zone->at(0, 0) == before);
    CHECK(both.zone->changes(0).size() == 1);
}

TEST_CASE(
    "long windows, operators with an inner state of their own and unknown values are refused") {
    Random random(5);
    Graph graph = random_graph(random, 0, false);
    graph.nodes.push_back({Kind::least, 4, rtamt::early::none, 0, 300, 300, {}});
    const std::array<Bounds, 2> ranges{rtamt::bounds::anything, rtamt::bounds::anything};
    const std::array<std::uint32_t, 1> output{6};
    CHECK(!ZoneEngine::of(graph, output, {}, ranges, ZoneEngine::crossover));
    CHECK(ZoneEngine::of(graph, output, {}, ranges, long_enough));
    const std::vector<Item> unbounded{{Item::Kind::all, false, 6}};
    CHECK(!ZoneEngine::of(graph, output, unbounded, ranges, long_enough));
    graph.nodes.back().kind = Kind::held;
    graph.nodes.back().low = graph.nodes.back().high = -1;
    CHECK(!ZoneEngine::of(graph, output, {}, ranges, long_enough));
    graph.nodes.back() = {Kind::least, 4, rtamt::early::none, 0, forever, forever, {}};
    CHECK(!ZoneEngine::of(graph, output, {}, ranges, long_enough));
}

TEST_CASE("a state of another monitor is refused") {
    Random random(7);
    const Graph graph = until_graph(random, 3);
    Both both(graph, {10, 12}, rtamt::bounds::anything);
    both.row(0, random_row(random, rtamt::bounds::anything));
    rtamt::Snapshot written;
    both.zone->transfer(written);
    auto bytes = written.bytes();
    for (std::size_t size = 0; size < bytes.size(); ++size) {
        rtamt::Snapshot cut(
            std::span<const std::uint8_t>(bytes).first(std::max<std::size_t>(size, 4)));
        if (size >= 4) CHECK_THROWS_AS(both.zone->transfer(cut), std::invalid_argument);
    }
    bytes[bytes.size() - 1] = bytes[bytes.size() - 2] = 0xFF; // no number
    rtamt::Snapshot forged{std::span<const std::uint8_t>(bytes)};
    CHECK_THROWS_AS(both.zone->transfer(forged), std::invalid_argument);
}
