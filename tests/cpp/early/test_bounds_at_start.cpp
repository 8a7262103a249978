#include "early/bounds_at_start.hpp"

#include "check.hpp"
#include "oracle.hpp"
#include "program/snapshot.hpp"

#include <array>

using namespace early_oracle;
using rtamt::early::BoundsAtStart;
using rtamt::early::BoundsEngine;
using rtamt::early::Item;
using rtamt::early::none;

namespace {

constexpr Tick end_of_test = 24;

// Bounds at the start by two engines: one that follows what they are put together from and drops
// what is not needed, and one that keeps the values of all nodes at all ticks.
struct Both {
    BoundsEngine lean;
    BoundsEngine whole;
    BoundsAtStart start;
    BoundsAtStart expected;

    Both(const Graph& graph, const std::vector<Item>& items, const Bounds& range,
         BoundsAtStart::Use use)
        : lean(graph, {range, range}, BoundsEngine::Arrival::rows),
          whole(graph, {range, range}, BoundsEngine::Arrival::rows), start(items, lean, {}, use),
          expected(items, whole, {}, BoundsAtStart::Use::as_given) {
        std::vector<Tick> last(graph.nodes.size(), -1);
        start.limit(last);
        lean.limit(last);
    }

    void row(Tick t, const std::array<Bounds, 2>& values) {
        REQUIRE(!lean.row(t, std::span<const Bounds>(values)));
        REQUIRE(!whole.row(t, std::span<const Bounds>(values)));
        start.read(lean, t);
        expected.read(whole);
    }

    void settle(Tick t) {
        std::vector<Tick> wanted(lean.size(), forever);
        start.settle(lean, t, wanted);
        lean.settle(t, wanted);
    }

    void compare_supposed(Tick t, const Bounds& supposed) {
        const std::vector<BoundsEngine::Supposition> later{{t + 1, forever, {supposed, supposed}}};
        REQUIRE(!lean.suppose(later));
        REQUIRE(!whole.suppose(later));
        BoundsAtStart found = start;
        BoundsAtStart wanted = expected;
        found.read(lean, t);
        wanted.read(whole);
        REQUIRE(found.value() == wanted.value());
        lean.revert();
        whole.revert();
    }

    void restore() {
        rtamt::Snapshot written;
        lean.transfer(written);
        start.transfer(written);
        rtamt::Snapshot read(written.bytes());
        lean.transfer(read);
        start.transfer(read);
        read.end();
    }
};

// A formula at the start: a value, or two that are connected.
std::vector<Item> random_items(Random& random, const Graph& graph) {
    std::vector<Item> items;
    const auto count = static_cast<std::uint32_t>(random.between(1, 3));
    const auto last = static_cast<std::uint32_t>(2 * graph.nodes.size() - 1);
    for (std::uint32_t i = 0; i < count; ++i) {
        Item item;
        item.negated = random.chance(30);
        item.a = last - static_cast<std::uint32_t>(random.between(0, 5));
        items.push_back(item);
    }
    for (std::uint32_t i = 1; i < count; ++i) {
        const auto kind = random.chance(50) ? Item::Kind::both : Item::Kind::either;
        const auto before = i == 1 ? 0 : static_cast<std::uint32_t>(items.size() - 1);
        items.push_back({kind, random.chance(30), before, i, none, 0});
    }
    return items;
}

} // namespace

TEST_CASE("bounds at the start are those of the node, put together or not") {
    for (std::uint32_t seed = 0; seed < 600; ++seed) {
        CAPTURE(seed);
        Random random(seed);
        const Graph graph = random_graph(random, 6, seed % 2 == 0);
        const Bounds range = random.chance(50) ? Bounds{-12, 12} : rtamt::bounds::anything;
        const auto use = seed % 4 < 2 ? BoundsAtStart::Use::in_order : BoundsAtStart::Use::late;
        Both both(graph, random_items(random, graph), range, use);
        REQUIRE(both.start.value() == both.expected.value());
        // In dense time the trace goes on when its samples end.
        const bool discrete = std::ranges::none_of(
            graph.nodes, [](const Node& node) { return node.kind == Kind::since_dense; });
        for (Tick t = 0; t < end_of_test; t += random.chance(90) ? 1 : 3) {
            std::array<Bounds, 2> row{};
            for (Bounds& each : row) {
                const double a = random.number(0);
                each = random.chance(80) ? Bounds{a, a} : Bounds{a, a + 1};
                if (random.chance(10) || each.lower < range.lower || each.upper > range.upper)
                    each = range;
            }
            both.row(t, row);
            REQUIRE(both.start.value() == both.expected.value());
            if (random.chance(20)) both.compare_supposed(t, row[0]);
            if (discrete) {
                const Bounds ended = both.expected.ended(both.whole, t + 1);
                REQUIRE(both.start.ended(both.lean, t + 1) == ended);
            }
            if (random.chance(30)) both.settle(t);
            if (random.chance(10)) both.restore();
        }
    }
}

TEST_CASE("memory at the start is that of the operands of windows") {
    constexpr Tick k = 2000;
    Graph graph;
    graph.inputs = 1;
    Node atom;
    atom.steps = {{Opcode::input, 0}};
    graph.nodes = {
        atom, {Kind::least, 0, none, 0, k, k, {}}, {Kind::greatest, 2, none, 0, k, 2 * k, {}}};
    Both both(graph, {{Item::Kind::value, false, 4, none, none, 0}}, rtamt::bounds::anything,
              BoundsAtStart::Use::late);
    Random random(1);
    std::size_t most = 0;
    for (Tick t = 0; t < 3 * k; ++t) {
        const double x = random.number(0);
        both.row(t, {Bounds{x, x}, Bounds{x, x}});
        if (t % 64 == 0) both.settle(t);
        most = std::max(most, both.lean.bytes());
        REQUIRE(both.start.value() == both.expected.value());
    }
    CHECK(both.start.value().lower == both.start.value().upper);
    CHECK(most < 100'000);             // two numbers for each tick of a window
    CHECK(both.lean.bytes() < 20'000); // nothing is followed any more
}
