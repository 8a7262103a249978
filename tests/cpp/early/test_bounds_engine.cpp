#include "early/bounds_engine.hpp"

#include "program/snapshot.hpp"

#include "check.hpp"
#include "oracle.hpp"

#include <array>
#include <cmath>

using namespace early_oracle;
using rtamt::early::BoundsEngine;
using Observation = BoundsEngine::Observation;

namespace {

constexpr Tick end_of_test = 14;
constexpr std::size_t span_of_test = end_of_test;

Bounds random_bounds(Random& random) {
    const double a = random.number(0);
    const double b = random.chance(50) ? a : random.number(5);
    return {std::min(a, b), std::max(a, b)};
}

void check_all(const BoundsEngine& engine, const Graph& graph, const Knowledge& known, Tick from) {
    const auto expected = bounds(graph, known, span_of_test + 6);
    for (std::uint32_t i = 0; i < graph.nodes.size(); ++i) {
        for (auto t = static_cast<std::size_t>(from); t < expected[i].size(); ++t) {
            const Bounds found = engine.at(2 * i, static_cast<Tick>(t));
            REQUIRE(found == expected[i][t]);
            REQUIRE(engine.at(2 * i + 1, static_cast<Tick>(t)) == Interval::neg(expected[i][t]));
        }
    }
}

// The narrower of two bounds.
Bounds narrowed(const Bounds& a, const Bounds& b) {
    return {std::max(a.lower, b.lower), std::min(a.upper, b.upper)};
}

// Pieces that nodes hand on for each row: what an update costs.
double pieces_of(const Graph& graph) {
    constexpr Tick rows = 20'000;
    BoundsEngine engine(graph, {}, BoundsEngine::Arrival::rows);
    Random random(1);
    std::vector<Tick> wanted(graph.nodes.size(), forever);
    std::size_t pieces = 0;
    for (Tick t = 0; t < rows; ++t) {
        const std::array<double, 1> row{random.number(0)};
        REQUIRE(!engine.row(t, std::span<const double>(row)));
        for (std::uint32_t i = 0; i < graph.nodes.size(); ++i)
            pieces += engine.new_data(2 * i, 0).size() + engine.new_data(2 * i, 1).size();
        wanted.back() = std::max<Tick>(0, t + 1 - graph.nodes.back().horizon);
        engine.settle(t, wanted);
    }
    return static_cast<double>(pieces) / static_cast<double>(rows);
}

} // namespace

TEST_CASE("bounds after every row of samples are those of the definition") {
    for (std::uint32_t seed = 0; seed < 400; ++seed) {
        CAPTURE(seed);
        Random random(seed);
        const Graph graph = random_graph(random, 5, true);
        const Bounds range = random.chance(50) ? Bounds{-12, 12} : rtamt::bounds::anything;
        BoundsEngine engine(graph, {range, range}, BoundsEngine::Arrival::rows);
        Knowledge known(2, {range});
        check_all(engine, graph, known, 0);
        for (Tick t = 0; t < end_of_test; ++t) {
            std::array<Bounds, 2> row{};
            for (std::size_t k = 0; k < 2; ++k) {
                row[k] = random.chance(20) ? range : narrowed(random_bounds(random), range);
                if (row[k].lower > row[k].upper) row[k] = range;
                known[k].insert(known[k].end() - 1, row[k]);
            }
            REQUIRE(!engine.row(t, std::span<const Bounds>(row)));
            check_all(engine, graph, known, 0);
        }
    }
}

TEST_CASE("what is required up to a tick alone has the bounds of the definition there") {
    for (std::uint32_t seed = 0; seed < 300; ++seed) {
        CAPTURE(seed);
        Random random(seed);
        const Graph graph = random_graph(random, 5, true);
        BoundsEngine engine(graph, {}, BoundsEngine::Arrival::rows);
        const auto root = static_cast<std::uint32_t>(graph.nodes.size() - 1);
        std::vector<Tick> last(graph.nodes.size(), -1);
        last[root] = random.between(0, 4);
        engine.limit(last);
        Knowledge known(2, {rtamt::bounds::anything});
        for (Tick t = 0; t < end_of_test; ++t) {
            const std::array<double, 2> row{random.number(0), random.number(0)};
            for (std::size_t k = 0; k < 2; ++k)
                known[k].insert(known[k].end() - 1, Interval::of(row[k]));
            REQUIRE(!engine.row(t, std::span<const double>(row)));
            const auto expected = bounds(graph, known, span_of_test + 6)[root];
            for (Tick asked = 0; asked <= last[root]; ++asked)
                REQUIRE(engine.at(2 * root, asked) == expected[static_cast<std::size_t>(asked)]);
        }
    }
}

TEST_CASE("knowledge in any order gives the bounds of the definition") {
    for (std::uint32_t seed = 0; seed < 400; ++seed) {
        CAPTURE(seed);
        Random random(seed);
        const Graph graph = random_graph(random, 5, true);
        BoundsEngine engine(graph, {}, BoundsEngine::Arrival::pieces);
        Knowledge known(2, std::vector<Bounds>(span_of_test + 1, rtamt::bounds::anything));
        for (int i = 0; i < 12; ++i) {
            const auto input = static_cast<std::uint32_t>(random.between(0, 1));
            const Tick l = random.between(0, end_of_test - 1);
            const bool rest = random.chance(10);
            const Tick r = rest ? forever : std::min(end_of_test - 1, l + random.between(0, 5));
            const Bounds bounds = random_bounds(random);
            std::vector<Observation> observations; // each within what was known
            for (Tick t = l; t <= std::min(r, end_of_test); ++t) {
                Bounds& now = known[input][static_cast<std::size_t>(t)];
                const Bounds both = narrowed(now, bounds);
                if (both.lower > both.upper) continue;
                now = both;
                const Tick end = t == end_of_test ? forever : t;
                observations.push_back({input, t, end, both});
            }
            REQUIRE(!engine.learn(observations, observations.empty() ? -1 : observations.back().l));
            for (std::uint32_t k = 0; k < 2; ++k)
                REQUIRE(engine.known(k, l) == known[k][static_cast<std::size_t>(l)]);
            check_all(engine, graph, known, 0);
        }
    }
}

TEST_CASE("rows in any order give the bounds of the definition") {
    for (std::uint32_t seed = 0; seed < 400; ++seed) {
        CAPTURE(seed);
        Random random(seed);
        const Graph graph = random_graph(random, 5, true);
        BoundsEngine engine(graph, {}, BoundsEngine::Arrival::late_rows);
        Knowledge known(2, std::vector<Bounds>(span_of_test + 1, rtamt::bounds::anything));
        for (int i = 0; i < 20; ++i) {
            const auto place = static_cast<std::size_t>(random.between(0, end_of_test - 1));
            std::vector<std::uint32_t> changed;
            std::array<Bounds, 2> row{known[0][place], known[1][place]};
            for (std::uint32_t input = 0; input < 2; ++input) {
                const Bounds both = narrowed(row[input], random_bounds(random));
                if (both.lower > both.upper || random.chance(30)) continue;
                known[input][place] = row[input] = both;
                changed.push_back(input);
            }
            REQUIRE(!engine.late_row(static_cast<Tick>(place), row, changed));
            check_all(engine, graph, known, 0);
        }
    }
}

TEST_CASE("an operation of a late row without a value is an error where no better row can come") {
    Graph graph;
    graph.inputs = 1;
    graph.nodes.emplace_back().steps = {{Opcode::input, 0}, {Opcode::sqrt, 0}};
    BoundsEngine engine(graph, {}, BoundsEngine::Arrival::late_rows);
    const std::array<std::uint32_t, 1> all{0};
    engine.settle_inputs(2);
    const std::array<Bounds, 1> open{{{-3, -2}}};
    REQUIRE(!engine.late_row(3, open, all));
    CHECK(engine.at(0, 3) == Bounds{0, rtamt::infinity}); // what was known before
    const auto closed = engine.close_inputs(3);
    REQUIRE(closed);
    CHECK(closed->tick == 3);
    const std::array<Bounds, 1> exact{{{-1, -1}}};
    const auto failure = engine.late_row(4, exact, all);
    REQUIRE(failure);
    CHECK(failure->node == 0);
    CHECK(failure->step == 1);
    CHECK(failure->tick == 4);
    const std::array<Bounds, 1> fine{{{4, 4}}};
    REQUIRE(!engine.late_row(4, fine, all));
    CHECK(engine.at(0, 4) == Bounds{2, 2});
}

TEST_CASE("what is final is dropped and the rest stays right, also in a restored engine") {
    for (std::uint32_t seed = 0; seed < 200; ++seed) {
        CAPTURE(seed);
        Random random(seed);
        const Graph graph = random_graph(random, 5, false);
        BoundsEngine engine(graph, {}, BoundsEngine::Arrival::rows);
        Knowledge known(2, {rtamt::bounds::anything});
        const auto root = static_cast<std::uint32_t>(graph.nodes.size() - 1);
        for (Tick t = 0; t < end_of_test; ++t) {
            const std::array<double, 2> row{random.number(0), random.number(0)};
            for (std::size_t k = 0; k < 2; ++k)
                known[k].insert(known[k].end() - 1, Interval::of(row[k]));
            REQUIRE(!engine.row(t, std::span<const double>(row)));
            const Tick open = std::max<Tick>(0, t + 1 - graph.nodes[root].horizon);
            std::vector<Tick> wanted(graph.nodes.size(), forever);
            wanted[root] = open;
            engine.settle(t, wanted);
            if (random.chance(30)) {
                rtamt::Snapshot written;
                engine.transfer(written);
                BoundsEngine other(graph, {}, BoundsEngine::Arrival::rows);
                rtamt::Snapshot read(written.bytes());
                other.transfer(read);
                read.end();
                engine = std::move(other);
            }
            const auto expected = bounds(graph, known, span_of_test + 6)[root];
            for (auto k = static_cast<std::size_t>(open); k < expected.size(); ++k)
                REQUIRE(engine.at(2 * root, static_cast<Tick>(k)) == expected[k]);
        }
    }
}

TEST_CASE("the pieces of new_data are exactly what has changed") {
    for (std::uint32_t seed = 0; seed < 100; ++seed) {
        CAPTURE(seed);
        Random random(seed);
        const Graph graph = random_graph(random, 5, true);
        BoundsEngine engine(graph, {}, BoundsEngine::Arrival::rows);
        Knowledge known(2, {rtamt::bounds::anything});
        for (Tick t = 0; t < end_of_test; ++t) {
            const auto before = bounds(graph, known, span_of_test);
            const std::array<double, 2> row{random.number(0), random.number(0)};
            for (std::size_t k = 0; k < 2; ++k)
                known[k].insert(known[k].end() - 1, Interval::of(row[k]));
            REQUIRE(!engine.row(t, std::span<const double>(row)));
            const auto after = bounds(graph, known, span_of_test);
            for (std::uint32_t i = 0; i < graph.nodes.size(); ++i) {
                for (Tick k = 0; k < end_of_test; ++k) {
                    const auto place = static_cast<std::size_t>(k);
                    Bounds replayed = before[i][place];
                    for (const auto& piece : engine.new_data(2 * i, 0)) {
                        if (piece.l > k || k > piece.r) continue;
                        REQUIRE(piece.old == replayed.lower);
                        replayed.lower = piece.now;
                    }
                    for (const auto& piece : engine.new_data(2 * i, 1)) {
                        if (piece.l > k || k > piece.r) continue;
                        REQUIRE(piece.old == -replayed.upper);
                        replayed.upper = -piece.now;
                    }
                    REQUIRE(replayed == after[i][place]);
                }
            }
        }
    }
}

TEST_CASE("an operation without a value is named, and changes nothing") {
    Graph graph;
    graph.inputs = 2;
    Node root;
    root.steps = {{Opcode::input, 0}, {Opcode::sqrt, 0}};
    Node window;
    window.kind = Kind::greatest;
    window.a = 0;
    window.low = -2;
    graph.nodes = {root, window};
    BoundsEngine engine(graph, {}, BoundsEngine::Arrival::pieces);
    const Observation fine{0, 0, 3, Interval::of(4)};
    REQUIRE(!engine.learn(std::span(&fine, 1), 0));
    const std::array<Observation, 2> wrong{
        {{0, 4, 4, Interval::of(9)}, {0, 5, 5, Interval::of(-1)}}};
    const auto failure = engine.learn(wrong, 5);
    REQUIRE(failure);
    CHECK(failure->node == 0);
    CHECK(failure->step == 1);
    CHECK(failure->tick == 5);
    CHECK(engine.at(0, 4) == Bounds{0, rtamt::infinity});
    CHECK(engine.at(2, 5) == Bounds{2, rtamt::infinity});
    CHECK(engine.known(0, 4) == rtamt::bounds::anything);
    // Bounds outside its domain wait for better ones, unless none will come.
    const Observation open{0, 4, 4, {-3, -2}};
    REQUIRE(!engine.learn(std::span(&open, 1), 4));
    engine.settle_inputs(4);
    const Observation closed{0, 4, 4, {-3, -2.5}};
    CHECK(engine.learn(std::span(&closed, 1), 4));
}

TEST_CASE(
    "of several parts and ticks without a value the first part is named, and its first tick") {
    Graph graph;
    graph.inputs = 2;
    Node sum; // sqrt(x) + sqrt(y)
    sum.steps = {{Opcode::input, 0},
                 {Opcode::sqrt, 0},
                 {Opcode::input, 1},
                 {Opcode::sqrt, 2},
                 {Opcode::add, 1, 3}};
    graph.nodes = {sum};
    BoundsEngine engine(graph, {}, BoundsEngine::Arrival::pieces);
    const Observation late[] = {
        {1, 2, 2, {-1, -1}}, {0, 6, 6, {-1, -1}}, {0, 4, 4, {-1, -1}}, {1, 3, 3, {-1, -1}}};
    for (int round = 0; round < 2; ++round) {
        const auto failure = engine.learn(late, 6);
        CHECK((failure && failure->step == 1 && failure->tick == 4));
    }
    const Observation one[] = {{1, 2, 2, {-1, -1}}};
    const auto failure = engine.learn(one, 6);
    CHECK((failure && failure->step == 3 && failure->tick == 2));
    const Observation sound[] = {{0, 0, 6, {4, 4}}, {1, 0, 6, {9, 9}}};
    CHECK(!engine.learn(sound, 6));
    CHECK((engine.at(0, 4) == Bounds{5, 5}));
}

TEST_CASE("the number of pieces does not depend on the bounds of windows") {
    for (const Kind kind : {Kind::least, Kind::since}) {
        std::array<double, 2> pieces{};
        for (std::size_t i = 0; i < 2; ++i) {
            const Tick bound = i == 0 ? 10 : 5000;
            Graph graph;
            graph.inputs = 1;
            Node atom;
            atom.steps = {{Opcode::input, 0}};
            Node soon;
            soon.kind = Kind::greatest;
            soon.a = 0;
            soon.high = soon.horizon = bound;
            Node root = soon;
            root.kind = kind;
            root.a = 2;
            if (kind == Kind::since) {
                root.b = 1;
                root.high = 0;
            } else {
                root.horizon = 2 * bound;
            }
            graph.nodes = {atom, soon, root};
            pieces[i] = pieces_of(graph);
        }
        CHECK(pieces[1] <= 1.2 * pieces[0]);
    }
}
