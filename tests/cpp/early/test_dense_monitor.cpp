#include "early/dense_monitor.hpp"

#include "check.hpp"
#include "oracle.hpp"
#include "program/snapshot.hpp"

#include <array>
#include <map>
#include <variant>

using namespace early_oracle;
using rtamt::early::BoundChange;
using rtamt::early::Decision;
using rtamt::early::DenseMonitor;
using rtamt::early::DenseSettings;

namespace {

constexpr Tick begin_of_test = -3;
constexpr std::size_t count = 40; // ticks that are looked at

// What is known of the inputs from the start on, where the samples of each come in order.
struct Model {
    std::array<std::map<Tick, Bounds>, 2> inputs;
    std::array<Bounds, 2> later{rtamt::bounds::anything, rtamt::bounds::anything};
    bool finished = false;

    [[nodiscard]] bool started() const { return !inputs[0].empty() && !inputs[1].empty(); }
    [[nodiscard]] Tick start() const {
        return std::max(inputs[0].begin()->first, inputs[1].begin()->first);
    }
    [[nodiscard]] Knowledge knowledge() const {
        Knowledge known(2);
        for (std::size_t i = 0; i < 2; ++i) {
            const Tick newest = inputs[i].rbegin()->first;
            for (std::size_t k = 0; k <= count; ++k) {
                const Tick t = start() + static_cast<Tick>(k);
                const bool open = t > newest && !finished;
                known[i].push_back(open ? later[i] : std::prev(inputs[i].upper_bound(t))->second);
            }
        }
        return known;
    }
};

DenseSettings settings(const Graph& graph, bool decides) {
    const auto root = static_cast<std::uint32_t>(2 * graph.nodes.size() - 2);
    return {.outputs = {root, root + 1},
            .at_start = {},
            .ranges = {},
            .lateness = {},
            .decides = decides,
            .causes = {}};
}

// A monitor that has the same behind it.
DenseMonitor restored(DenseMonitor& monitor, const Graph& graph, bool decides) {
    rtamt::Snapshot written;
    monitor.transfer(written);
    DenseMonitor other(graph, settings(graph, decides));
    rtamt::Snapshot read(written.bytes());
    other.transfer(read);
    read.end();
    return other;
}

// Brings random samples to a monitor and calls `check` with the time after each, then at the end.
template <class Check>
void run(Random& random, DenseMonitor& monitor, Model& model, const Graph& graph, bool decides,
         int updates, Check&& check) {
    for (int i = 0; i < updates; ++i) {
        const auto input = static_cast<std::uint32_t>(random.between(0, 1));
        auto& column = model.inputs[input];
        const Tick time = column.empty() ? begin_of_test + random.between(0, 3)
                                         : column.rbegin()->first + random.between(1, 3);
        if (time - begin_of_test >= static_cast<Tick>(count) / 2) continue;
        const double x = random.number(0);
        const Bounds bounds{x, random.chance(70) ? x : x + 2};
        column[time] = bounds;
        const DenseMonitor::Given given{input, bounds};
        REQUIRE(!monitor.take(time, std::span(&given, 1)));
        check(time);
        if (random.chance(20)) monitor = restored(monitor, graph, decides);
    }
    if (!model.started()) return;
    model.finished = true;
    REQUIRE(!monitor.finish());
    check(*monitor.samples().newest());
}

} // namespace

TEST_CASE("bounds and their changes are those of the definition") {
    for (std::uint32_t seed = 0; seed < 300; ++seed) {
        CAPTURE(seed);
        Random random(seed);
        const Graph graph = random_graph(random, 4, true);
        DenseMonitor monitor(graph, settings(graph, false));
        Model model;
        std::map<Tick, Bounds> reported;
        run(random, monitor, model, graph, false, 20, [&](Tick /*time*/) {
            if (!model.started()) {
                CHECK(!monitor.at(0, 0));
                CHECK(monitor.changes(0).empty());
                return;
            }
            const auto expected = bounds(graph, model.knowledge(), count).back();
            for (const BoundChange& change : monitor.changes(0)) {
                for (Tick t = change.l; t <= change.r; ++t)
                    reported[t] = change.bounds;
            }
            const Tick newest = *monitor.samples().newest();
            for (Tick t = model.start(); t < model.start() + static_cast<Tick>(count) - 1; ++t) {
                const Bounds at = expected[static_cast<std::size_t>(t - model.start())];
                REQUIRE(monitor.at(0, t) == at);
                REQUIRE(monitor.at(1, t) == Interval::neg(at));
                REQUIRE(reported.contains(t) == (t <= newest));
                if (t <= newest) REQUIRE(reported[t] == at);
            }
            // What is supposed of an input holds behind its newest sample, and for one answer.
            const double x = random.number(0);
            model.later[0] = {x, x + 1};
            const auto supposed = bounds(graph, model.knowledge(), count).back();
            model.later[0] = rtamt::bounds::anything;
            const DenseMonitor::Supposed later{0, -rtamt::early::forever, {x, x + 1}};
            const Tick t = model.start() + random.between(0, count - 2);
            const auto k = static_cast<std::size_t>(t - model.start());
            const auto answer = monitor.suppose(0, t, std::span(&later, 1));
            REQUIRE(std::get<Bounds>(answer) == supposed[k]);
            REQUIRE(monitor.at(0, t) == expected[k]);
        });
    }
}

TEST_CASE("every tick is decided once, by the first sample that settles it") {
    for (std::uint32_t seed = 0; seed < 300; ++seed) {
        CAPTURE(seed);
        Random random(seed);
        const Graph graph = random_graph(random, 4, true);
        DenseMonitor monitor(graph, settings(graph, true));
        Model model;
        std::map<Tick, std::pair<bool, Tick>> settled; // verdict, and when
        std::map<Tick, std::pair<bool, Tick>> reported;
        run(random, monitor, model, graph, true, 20, [&](Tick time) {
            if (!model.started()) return;
            const auto expected = bounds(graph, model.knowledge(), count).back();
            for (std::size_t k = 0; k < expected.size(); ++k) {
                const Tick t = model.start() + static_cast<Tick>(k);
                if (expected[k].lower > 0) settled.try_emplace(t, true, time);
                if (expected[k].upper < 0) settled.try_emplace(t, false, time);
            }
            Tick after = std::numeric_limits<Tick>::min();
            for (const Decision& each : monitor.decisions(0)) {
                REQUIRE(each.l > after);
                after = each.r;
                for (Tick t = each.l; t <= each.r; ++t)
                    REQUIRE(reported.try_emplace(t, each.satisfied, each.at).second);
            }
            auto reached = settled;
            reached.erase(reached.upper_bound(*monitor.samples().newest()), reached.end());
            REQUIRE(reported == reached);
        });
    }
}

TEST_CASE("memory does not grow with the trace") {
    for (const bool late : {false, true}) {
        CAPTURE(late);
        Graph graph;
        graph.inputs = 1;
        Node atom;
        atom.steps = {{Opcode::input, 0}};
        Node window;
        window.kind = Kind::least;
        window.a = 0;
        window.high = window.horizon = 50;
        graph.nodes = {atom, window};
        DenseSettings own = settings(graph, false);
        if (late) own.lateness = 10;
        DenseMonitor monitor(graph, own);
        std::size_t early = 0;
        for (Tick t = 0; t < 20'000; ++t) {
            const DenseMonitor::Given given{0, Interval::of(static_cast<double>(t * 7919 % 100))};
            REQUIRE(!monitor.take(late ? t + 3 - (2 * (t % 4)) : t, std::span(&given, 1)));
            if (t == 1000) early = monitor.bytes();
        }
        CHECK(monitor.bytes() <= 2 * early);
    }
}

TEST_CASE("a sample that makes an operation undefined changes nothing") {
    Graph graph;
    graph.inputs = 1;
    Node atom;
    atom.steps = {{Opcode::input, 0}, {Opcode::sqrt, 0}};
    graph.nodes = {atom};
    DenseMonitor monitor(graph, settings(graph, false));
    const DenseMonitor::Given fine{0, Interval::of(4)};
    const DenseMonitor::Given wrong{0, Interval::of(-4)};
    REQUIRE(monitor.take(10, std::span(&wrong, 1)));
    CHECK(!monitor.samples().newest());
    REQUIRE(!monitor.take(10, std::span(&fine, 1)));
    const auto failure = monitor.take(15, std::span(&wrong, 1));
    REQUIRE(failure);
    CHECK(failure->tick == 15);
    CHECK(monitor.samples().newest() == 10);
    CHECK(monitor.at(0, 11) == Bounds{0, rtamt::infinity});
    REQUIRE(!monitor.take(12, std::span(&fine, 1)));
    CHECK(monitor.at(0, 11) == Bounds{2, 2});
}

TEST_CASE("a first sample that makes an operation undefined changes nothing") {
    Graph graph;
    graph.inputs = 2;
    Node atom;
    atom.steps = {{Opcode::input, 0}, {Opcode::sqrt, 0}, {Opcode::input, 1}, {Opcode::add, 1, 2}};
    graph.nodes = {atom};
    DenseSettings late = settings(graph, false);
    late.lateness = 5;
    late.several = true;
    DenseMonitor monitor(graph, late);
    const auto take = [&](Tick time, std::uint32_t input, double value) {
        const DenseMonitor::Given given{input, Interval::of(value)};
        return monitor.take(time, std::span(&given, 1));
    };
    REQUIRE(!take(3, 0, -1)); // the trace may start later
    REQUIRE(!take(5, 1, 1));
    const std::size_t bytes = monitor.bytes();
    for (const Tick time : {Tick{2}, Tick{3}}) {
        const auto failure = take(time, 1, 1);
        REQUIRE(failure);
        CHECK(failure->tick == 3);
    }
    const DenseMonitor::Given given{0, Interval::of(4)};
    monitor.stage(4, std::span(&given, 1), std::nullopt);
    REQUIRE(!monitor.attempt());
    monitor.reject();
    CHECK(monitor.bytes() == bytes);
    const auto failure = take(5, 0, -4);
    REQUIRE(failure);
    CHECK(failure->tick == 5);
    REQUIRE(!take(4, 0, 4));
    CHECK(!monitor.trace_start());
    REQUIRE(!take(20, 0, 9));
    CHECK(monitor.trace_start() == 5);
    CHECK(monitor.at(0, 5) == Bounds{3, 3});
}
