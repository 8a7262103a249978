#include "early/eager_engine.hpp"

#include "program/snapshot.hpp"

#include "check.hpp"
#include "oracle.hpp"

#include <array>
#include <cstring>
#include <optional>
#include <span>
#include <vector>

using namespace early_oracle;
using rtamt::early::BoundsEngine;
using rtamt::early::Decided;
using rtamt::early::EagerEngine;
using rtamt::early::Kleene;
using rtamt::early::none;
using rtamt::early::Piece;
using rtamt::early::Step;
using Row = std::array<Bounds, 2>;

namespace {

constexpr Tick beyond = 40; // ticks behind the newest that are compared

Node atom(Random& random) {
    Node node;
    node.steps = {{Opcode::input, random.chance(50) ? 1U : 0U},
                  {Opcode::constant, none, none, random.number(0)}};
    if (random.chance(20)) node.steps[1] = {Opcode::input, 1};
    const bool swapped = random.chance(30);
    node.steps.push_back({random.chance(50) ? Opcode::holds_ge : Opcode::holds_gt,
                          swapped ? 1U : 0U, swapped ? 0U : 1U});
    if (random.chance(30)) node.steps.push_back({Opcode::neg, 2});
    if (random.chance(10)) { // two comparisons of an input
        node.steps.push_back({random.chance(50) ? Opcode::holds_ge : Opcode::holds_gt, 0, 1});
        const auto last = static_cast<std::uint32_t>(node.steps.size() - 1);
        node.steps.push_back({random.chance(50) ? Opcode::min : Opcode::max, last - 1, last});
    }
    if (random.chance(5)) {
        const double truth = random.chance(50) ? rtamt::infinity : -rtamt::infinity;
        node.steps = {{Opcode::constant, none, none, truth}};
    }
    return node;
}

// Truth values alone; `far`: how long windows are.
Graph truth_graph(Random& random, int size, Tick far) {
    Graph graph;
    graph.inputs = 2;
    for (int i = 0; i < 3; ++i)
        graph.nodes.push_back(atom(random));
    constexpr Kind kinds[] = {Kind::both,     Kind::either, Kind::least,
                              Kind::greatest, Kind::since,  Kind::until};
    for (int i = 0; i < size; ++i) {
        Node node;
        node.kind = kinds[random.between(0, 5)];
        node.a = pick(random, graph.nodes.size());
        if (node.kind == Kind::least || node.kind == Kind::greatest) {
            const Tick begin = random.chance(50) ? 0 : random.between(0, far);
            const Tick end = random.chance(15) ? forever : begin + random.between(0, far);
            const bool past = random.chance(40);
            node.low = past ? -end : begin;
            node.high = past ? -begin : end;
        } else {
            node.b = pick(random, graph.nodes.size());
        }
        node.horizon = horizon(graph, node);
        graph.nodes.push_back(node);
    }
    graph.check();
    return graph;
}

Row random_row(Random& random, const Bounds& range, int unknown) {
    Row row{};
    for (Bounds& each : row) {
        const double a = random.number(0);
        const double b = random.chance(100 - unknown) ? a : random.number(5);
        each = {std::max(std::min(a, b), range.lower), std::min(std::max(a, b), range.upper)};
        if (random.chance(unknown / 2) || each.lower > each.upper) each = range;
    }
    return row;
}

Kleene kleene(const Bounds& bounds) {
    if (bounds.lower > 0) return Kleene::holds;
    return bounds.upper < 0 ? Kleene::fails : Kleene::open;
}

// Both engines, over the same samples.
struct Both {
    Both(const Graph& graph, const Bounds& range)
        : eager(EagerEngine::of(graph, std::array{range, range}).value()),
          bounds(graph, {range, range}, BoundsEngine::Arrival::rows) {}

    EagerEngine eager;
    BoundsEngine bounds;
    Tick newest = -1;

    void row(Tick t, const Row& values) {
        const bool exact = values[0].lower == values[0].upper && values[1].lower == values[1].upper;
        const std::array<double, 2> numbers{values[0].lower, values[1].lower};
        if (exact) {
            REQUIRE(!eager.row(t, std::span<const double>(numbers)));
        } else {
            REQUIRE(!eager.row(t, std::span<const Bounds>(values)));
        }
        REQUIRE(!bounds.row(t, std::span<const Bounds>(values)));
        newest = t;
    }

    void compare(std::uint32_t ref, Tick from) const {
        bool same = true;
        for (Tick t = from; t <= newest + beyond; ++t)
            same = same && eager.at(ref, t).value == kleene(bounds.at(ref, t));
        REQUIRE(same);
        REQUIRE(eager.at(ref, forever / 2).value == kleene(bounds.at(ref, forever / 2)));
    }

    // What the last row decided, up to some ticks behind it.
    void compare_news(std::uint32_t ref, Tick from) const {
        std::vector<Kleene> expected(static_cast<std::size_t>(newest + beyond + 1));
        std::vector<Kleene> found(expected.size());
        bool twice = false;
        const auto note = [&](std::vector<Kleene>& values, Tick l, Tick r, Kleene value) {
            for (Tick t = std::max(l, from); t <= std::min(r, newest + beyond); ++t) {
                twice = twice || values[static_cast<std::size_t>(t)] != Kleene::open;
                values[static_cast<std::size_t>(t)] = value;
            }
        };
        for (const int reg : {0, 1}) {
            for (const Piece& piece : bounds.new_data(ref & ~1U, reg))
                note(expected, piece.l, piece.r, reg == 0 ? Kleene::holds : Kleene::fails);
        }
        for (const Decided& piece : eager.decided(ref))
            note(found, piece.l, piece.r, piece.value);
        REQUIRE_FALSE(twice);
        REQUIRE((found == expected));
    }

    void compare_end(std::span<const std::uint32_t> refs, Tick from) const {
        const auto found = eager.ended(refs, newest + 1);
        const auto expected = bounds.ended(refs, newest + 1);
        for (std::size_t k = 0; k < refs.size(); ++k) {
            REQUIRE(found[k].first == expected[k].first);
            for (std::size_t i = 0; i < expected[k].bounds.size(); ++i) {
                if (expected[k].first + static_cast<Tick>(i) >= from)
                    REQUIRE(found[k].bounds[i] == expected[k].bounds[i]);
            }
        }
    }

    void restore() {
        rtamt::Snapshot written;
        eager.transfer(written);
        rtamt::Snapshot read(written.bytes());
        eager.transfer(read);
        read.end();
    }
};

void compare_all(Random& random, Tick far, int samples, int unknown) {
    const Bounds range = random.chance(30) ? Bounds{-3, 12} : rtamt::bounds::anything;
    const Graph graph = truth_graph(random, static_cast<int>(random.between(1, 6)), far);
    Both both(graph, range);
    const auto refs = static_cast<std::uint32_t>(2 * graph.nodes.size());
    for (std::uint32_t ref = 0; ref < refs; ++ref)
        both.compare(ref, 0);
    for (Tick t = 0; samples-- > 0;) {
        both.row(t, random_row(random, range, unknown));
        for (std::uint32_t ref = 0; ref < refs; ++ref)
            both.compare(ref, 0);
        for (std::uint32_t ref = 0; ref < refs; ref += 2)
            both.compare_news(ref, 0);
        t += random.chance(90) ? 1 : random.between(2, 20);
    }
}

// With what no output needs any more dropped, and restored states.
void compare_outputs(Random& random, Tick far, int samples, int unknown) {
    const Bounds range = random.chance(30) ? Bounds{-3, 12} : rtamt::bounds::anything;
    const Graph graph = truth_graph(random, static_cast<int>(random.between(1, 6)), far);
    const std::array<std::uint32_t, 2> outputs{
        static_cast<std::uint32_t>(2 * graph.nodes.size() - 2), pick(random, graph.nodes.size())};
    Both both(graph, range);
    std::array<Tick, 2> from{0, 0};
    for (Tick t = 0; samples-- > 0;) {
        both.row(t, random_row(random, range, unknown));
        for (std::size_t k = 0; k < 2; ++k) {
            both.compare(outputs[k], from[k]);
            both.compare_news(outputs[k], from[k]);
        }
        if (random.chance(30)) {
            std::vector<Tick> wanted(graph.nodes.size(), forever);
            for (std::size_t k = 0; k < 2; ++k) {
                const Tick final_before = t + 1 - graph.nodes[outputs[k] / 2].horizon;
                from[k] = std::max(from[k], random.chance(50) ? final_before : 0);
                Tick& first = wanted[outputs[k] / 2];
                first = std::min(first, from[k]);
            }
            both.eager.settle(t, wanted);
            both.bounds.settle(t, wanted);
        }
        if (random.chance(10)) both.restore();
        if (random.chance(10)) both.compare_end(outputs, std::max(from[0], from[1]));
        t += random.chance(90) ? 1 : random.between(2, 20);
    }
}

} // namespace

TEST_CASE("every tick of every node is decided as its bounds tell, with the same row") {
    for (std::uint32_t seed = 0; seed < 1500; ++seed) {
        CAPTURE(seed);
        Random random(seed);
        compare_all(random, random.chance(50) ? 3 : 12, 24, random.chance(50) ? 0 : 30);
    }
}

TEST_CASE("outputs are decided as their bounds tell after what is not needed was dropped") {
    for (std::uint32_t seed = 0; seed < 1500; ++seed) {
        CAPTURE(seed);
        Random random(seed);
        compare_outputs(random, random.chance(50) ? 3 : 12, 40, random.chance(50) ? 0 : 30);
    }
}

TEST_CASE("windows of many chunks of runs are decided as their bounds tell") {
    for (std::uint32_t seed = 0; seed < 12; ++seed) {
        CAPTURE(seed);
        Random random(seed);
        compare_outputs(random, 600, 1500, seed % 2 == 0 ? 0 : 20);
    }
}

TEST_CASE("what is no truth value, and operators with an inner state, are refused") {
    Graph graph;
    graph.inputs = 1;
    graph.nodes.push_back({});
    graph.nodes[0].steps = {
        {Opcode::input, 0}, {Opcode::constant, none, none, 2.0}, {Opcode::holds_ge, 0, 1}};
    graph.nodes.push_back({Kind::greatest, 1, none, 0, 5, 5, {}});
    CHECK(EagerEngine::of(graph, {}));
    graph.nodes[1] = {Kind::held, 0, none, -1, -1, 0, {}};
    CHECK(!EagerEngine::of(graph, {}));
    graph.nodes[1] = {Kind::greatest, 0, none, 0, 5, 5, {}};
    graph.nodes[0].steps[2].opcode = Opcode::sub;
    CHECK(!EagerEngine::of(graph, {}));
    graph.nodes[0].steps = {{Opcode::input, 0},
                            {Opcode::sqrt, 0},
                            {Opcode::constant, none, none, 2.0},
                            {Opcode::holds_ge, 1, 2}};
    CHECK(EagerEngine::of(graph, {}));
    CHECK(!EagerEngine::of(graph, std::array{Bounds{-5.0, -1.0}})); // no sample has a value
}

TEST_CASE("a row without a value decides nothing") {
    Graph graph;
    graph.inputs = 1;
    graph.nodes.push_back({});
    graph.nodes[0].steps = {{Opcode::input, 0},
                            {Opcode::sqrt, 0},
                            {Opcode::constant, none, none, 2.0},
                            {Opcode::holds_ge, 1, 2}};
    EagerEngine engine = EagerEngine::of(graph, {}).value();
    const double right = 9.0;
    const double wrong = -1.0;
    CHECK(!engine.row(0, std::span<const double>(&right, 1)));
    const auto failure = engine.row(1, std::span<const double>(&wrong, 1));
    REQUIRE(failure);
    CHECK((failure->node == 0 && failure->step == 1 && failure->tick == 1));
    CHECK(engine.at(0, 0).value == Kleene::holds);
    CHECK(engine.at(0, 1).value == Kleene::open);
    CHECK(!engine.row(1, std::span<const double>(&right, 1)));
    CHECK(engine.at(1, 1).value == Kleene::fails);
}

TEST_CASE("a forged state is refused or decides what it decides") {
    Random random(11);
    Graph graph = truth_graph(random, 0, 0);
    graph.nodes.push_back({Kind::until, 0, 3, 0, 0, forever, {}});
    graph.nodes.push_back({Kind::since, 6, 2, 0, 0, forever, {}});
    graph.nodes.push_back({Kind::least, 8, none, 0, 7, forever, {}});
    graph.nodes.push_back({Kind::greatest, 10, none, -forever, -1, forever, {}});
    graph.nodes.push_back({Kind::either, 12, 5, 0, 0, forever, {}});
    Both both(graph, rtamt::bounds::anything);
    for (Tick t = 0; t < 10; ++t)
        both.row(t, random_row(random, rtamt::bounds::anything, 20));
    rtamt::Snapshot written;
    both.eager.transfer(written);
    constexpr std::array<std::uint64_t, 8> numbers{0,
                                                   1,
                                                   2,
                                                   3,
                                                   7,
                                                   static_cast<std::uint64_t>(forever),
                                                   ~std::uint64_t{0},
                                                   std::uint64_t{1} << 63U};
    int taken = 0;
    for (std::size_t place = 4; place + 8 <= written.bytes().size(); ++place) {
        for (const std::uint64_t number : numbers) {
            auto bytes = written.bytes();
            std::memcpy(bytes.data() + place, &number, sizeof number);
            EagerEngine engine = EagerEngine::of(graph, {}).value();
            try {
                rtamt::Snapshot read{std::span<const std::uint8_t>(bytes)};
                engine.transfer(read);
                read.end();
            } catch (const std::invalid_argument&) {
                continue;
            }
            ++taken;
            for (Tick t = 10; t < 14; ++t)
                CHECK(!engine.row(
                    t, std::span<const Bounds>(random_row(random, rtamt::bounds::anything, 20))));
            engine.settle(13, std::vector<Tick>(graph.nodes.size(), 5));
        }
    }
    CHECK(taken > 0);
}
