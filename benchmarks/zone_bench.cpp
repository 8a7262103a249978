// Bounds of every open instant in discrete time, in nanoseconds a sample, two ways:
//
//     zone_bench
//
// Delta: BoundsEngine follows what a sample changes. Zone: ZoneEngine computes all open ticks anew.
// Both compute always[0,k](a >= -2), and the same below eventually[0,k];
// ZoneEngine::ticks_to_follow follows from where their cost is the same.
#include "early/bounds_engine.hpp"
#include "early/zone_engine.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <random>
#include <span>
#include <vector>

namespace {

using rtamt::Opcode;
using rtamt::early::BoundsEngine;
using rtamt::early::Graph;
using rtamt::early::Kind;
using rtamt::early::Node;
using rtamt::early::none;
using rtamt::early::Tick;
using rtamt::early::ZoneEngine;

constexpr int rounds = 3;

Graph graph(Tick k, bool nested) {
    Graph graph;
    graph.inputs = 1;
    Node atom;
    atom.kind = Kind::atom;
    atom.steps = {{Opcode::input, 0, none, 0.0},
                  {Opcode::constant, none, none, -2.0},
                  {Opcode::sub, 0, 1, 0.0}};
    graph.nodes.push_back(atom);
    graph.nodes.push_back({Kind::least, 0, none, 0, k, k, {}});
    if (nested) graph.nodes.push_back({Kind::greatest, 2, none, 0, k, 2 * k, {}});
    return graph;
}

template <class Work>
double best_of(std::size_t samples, Work&& work) {
    double best = rtamt::infinity;
    for (int round = 0; round < rounds; ++round) {
        const std::clock_t start = std::clock(); // of this process, whatever else runs
        work();
        const double spent = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
        best = std::min(best, spent * 1e9 / static_cast<double>(samples));
    }
    return best;
}

double delta(Tick k, bool nested, std::span<const double> samples) {
    return best_of(samples.size(), [&] {
        BoundsEngine engine(graph(k, nested), {}, BoundsEngine::Arrival::rows);
        std::vector<Tick> wanted(engine.size(), rtamt::early::forever);
        const Tick horizon = nested ? 2 * k : k;
        for (std::size_t i = 0; i < samples.size(); ++i) {
            const auto t = static_cast<Tick>(i);
            if (engine.row(t, samples.subspan(i, 1))) std::puts("undefined");
            if (i % 64 != 0) continue;
            wanted.back() = std::max<Tick>(0, t - horizon);
            engine.settle(t, wanted);
        }
    });
}

double zone(Tick k, bool nested, std::span<const double> samples) {
    const Graph whole = graph(k, nested);
    const std::vector<std::uint32_t> outputs{nested ? 4U : 2U};
    return best_of(samples.size(), [&] {
        auto engine = ZoneEngine::of(whole, outputs, {}, {}, 1'000'000);
        for (std::size_t i = 0; i < samples.size(); ++i) {
            if (engine && engine->row(static_cast<Tick>(i), samples.subspan(i, 1)))
                std::puts("undefined");
        }
    });
}

} // namespace

int main() {
    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    std::vector<double> samples(100'000);
    for (double& sample : samples)
        sample = normal(random);
    for (const bool nested : {false, true}) {
        for (const Tick k : {1, 3, 10, 20, 30, 50, 100, 300, 1000}) {
            const double changes = delta(k, nested, samples);
            const auto some =
                std::span(samples).first(samples.size() / static_cast<std::size_t>(k / 10 + 1));
            const double all = zone(k, nested, some);
            std::printf("%s k = %4lld: delta %6.0f ns, zone %6.0f ns, ratio %.2f\n",
                        nested ? "two windows," : "one window, ", static_cast<long long>(k),
                        changes, all, changes / all);
        }
    }
    return 0;
}
