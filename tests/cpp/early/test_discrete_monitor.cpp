#include "early/discrete_monitor.hpp"

#include "check.hpp"

#include <cstdint>
#include <span>
#include <variant>
#include <vector>

using rtamt::Bounds;
using rtamt::Opcode;
using rtamt::early::Decision;
using rtamt::early::DiscreteMonitor;
using rtamt::early::DiscreteSettings;
using rtamt::early::Graph;
using rtamt::early::Item;
using rtamt::early::Kind;
using rtamt::early::none;
using rtamt::early::Tick;
using Failure = DiscreteMonitor::Failure;

namespace {

// always[0:2](sqrt(x)); the first tick is that of the sample.
Graph always() {
    Graph graph;
    graph.inputs = 1;
    graph.nodes.push_back({Kind::atom,
                           none,
                           none,
                           0,
                           0,
                           0,
                           {{Opcode::input, 0, none, 0.0}, {Opcode::sqrt, 0, none, 0.0}}});
    graph.nodes.push_back({Kind::least, 0, none, 0, 2, 2, {}});
    graph.check();
    return graph;
}

DiscreteSettings settings(bool decides, Tick zone = 0) {
    DiscreteSettings made;
    made.outputs = {2};
    if (!decides) made.at_start = {{Item::Kind::value, false, 2, none, none, 0}};
    made.ranges = {{-1.0, 100.0}};
    made.period = 0.5;
    made.tolerance = 0.1;
    made.decides = decides;
    made.zone = zone;
    return made;
}

std::optional<Failure> give(DiscreteMonitor& monitor, double time, double x) {
    const auto index = monitor.place(time);
    CHECK((index.has_value() && monitor.in_order(*index)));
    return monitor.row(*index, time, std::span<const double>(&x, 1));
}

} // namespace

TEST_CASE("bounds narrow sample by sample, with both engines") {
    for (const Tick zone : {0, 50}) {
        DiscreteMonitor monitor(always(), settings(false, zone));
        CHECK(monitor.computes_zone() == (zone != 0));
        CHECK_FALSE(give(monitor, 7.0, 16.0));
        CHECK((monitor.at_start()->upper == 4.0 && monitor.time(0) == 7.0));
        CHECK_FALSE(give(monitor, 7.5, 9.0));
        CHECK((monitor.bounds(0, 0)->upper == 3.0 && monitor.bounds(0, 1)->upper == 3.0));
        CHECK_FALSE(give(monitor, 8.0, 25.0));
        CHECK((*monitor.bounds(0, 0) == Bounds{3.0, 3.0}));
        const auto changes = monitor.changes(0);
        CHECK((!changes.empty() && monitor.is_final(0, changes.front())));
        const auto ended = monitor.finish();
        const auto& end = std::get<DiscreteMonitor::End>(ended);
        CHECK((*end.at_start == Bounds{3.0, 3.0} && end.outputs.size() == 1));
        CHECK(monitor.finished());
    }
}

TEST_CASE("verdicts come once, and the rest at the end") {
    DiscreteMonitor monitor(always(), settings(true));
    CHECK_FALSE(give(monitor, 0.0, 4.0));
    CHECK_FALSE(give(monitor, 0.5, 4.0));
    CHECK(monitor.decisions(0).empty());
    CHECK_FALSE(give(monitor, 1.0, 4.0));
    const std::vector<Decision>& decided = monitor.decisions(0);
    CHECK((decided.size() == 1 && decided[0].l == 0 && decided[0].at == 2 && decided[0].satisfied));
    CHECK(std::holds_alternative<DiscreteMonitor::End>(monitor.finish()));
    CHECK(monitor.decisions(0).size() == 2);
}

TEST_CASE("a sample without a value changes nothing") {
    DiscreteMonitor monitor(always(), settings(false));
    CHECK_FALSE(give(monitor, 0.0, 4.0));
    const auto failure = give(monitor, 0.5, -1.0);
    CHECK((failure && failure->node == 0 && failure->step == 1 && failure->tick == 1));
    CHECK((monitor.samples() == 1 && monitor.newest() == 0));
    CHECK_FALSE(monitor.place(0.8).has_value());
    CHECK_FALSE(monitor.in_order(*monitor.place(1.0)));
    CHECK_FALSE(give(monitor, 0.5, 1.0));
}

TEST_CASE("late samples narrow bounds up to the watermark") {
    DiscreteSettings made = settings(false);
    made.lateness = 2;
    DiscreteMonitor monitor(always(), made);
    const auto learn = [&](Tick index, double x) {
        const DiscreteMonitor::Observation seen{0, index, index, {x, x}};
        return monitor.learn(index, 0.5 * static_cast<double>(index), std::span(&seen, 1));
    };
    CHECK_FALSE(learn(0, 16.0));
    CHECK_FALSE(learn(2, 9.0));
    CHECK((monitor.closed() == -1 && monitor.bounds(0, 0)->lower != 2.0));
    CHECK_FALSE(learn(1, 4.0));
    CHECK((*monitor.bounds(0, 0) == Bounds{2.0, 2.0} && monitor.known(0, 1).lower == 4.0));
    CHECK_FALSE(monitor.watermark(1.0));
    CHECK(monitor.closed() == 2);
}

TEST_CASE("a state goes on as the monitor would") {
    for (const bool decides : {false, true}) {
        DiscreteMonitor monitor(always(), settings(decides));
        CHECK_FALSE(give(monitor, 0.0, 4.0));
        CHECK_FALSE(give(monitor, 0.5, 9.0));
        monitor.settle();
        rtamt::Snapshot written;
        monitor.transfer(written);
        DiscreteMonitor other(always(), settings(decides));
        rtamt::Snapshot read(written.bytes());
        other.transfer(read);
        read.end();
        CHECK((!give(other, 1.0, 1.0) && !give(monitor, 1.0, 1.0)));
        if (decides) {
            CHECK(other.decisions(0).size() == monitor.decisions(0).size());
        } else {
            CHECK(*other.bounds(0, 0) == *monitor.bounds(0, 0));
        }
    }
}

TEST_CASE("an output that does not exist is refused") {
    DiscreteSettings made = settings(true);
    made.outputs = {6};
    CHECK_THROWS_AS(DiscreteMonitor(always(), made), std::invalid_argument);
}
