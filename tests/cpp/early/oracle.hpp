// Random graphs, and their bounds by definition: tick by tick, from what is known of the inputs.
//
// Knowledge ends at a tick after which nothing but the ranges is known, so that values are the same
// from some tick on: columns reach far enough behind it.
#pragma once

#include "early/bounds_engine.hpp"

#include "discrete/oracle.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace early_oracle {

using oracle::Random;
using rtamt::Bounds;
using rtamt::Interval;
using rtamt::Opcode;
using rtamt::early::forever;
using rtamt::early::Graph;
using rtamt::early::Kind;
using rtamt::early::Node;
using rtamt::early::Tick;

// Of each input, its bounds at each tick; the last entry is that of all later ticks.
using Knowledge = std::vector<std::vector<Bounds>>;

inline std::uint32_t pick(Random& random, std::size_t nodes) {
    const auto last = static_cast<std::int64_t>(2 * nodes) - 1;
    return static_cast<std::uint32_t>(random.between(0, last));
}

// Horizons as the compiler has them; until has none by itself.
inline Tick horizon(const Graph& graph, const Node& node) {
    const auto of = [&](std::uint32_t ref) {
        return ref == rtamt::early::none ? 0 : graph.nodes[ref / 2].horizon;
    };
    const Tick below = std::max(of(node.a), of(node.b));
    if (node.kind == Kind::until) return forever;
    return below >= forever || node.high >= forever ? forever
                                                    : below + std::max<Tick>(0, node.high);
}

// `decided`: without until, so that every value is final some time.
inline Graph random_graph(Random& random, int size, bool with_until) {
    Graph graph;
    graph.inputs = 2;
    const auto add = [&](Node node) {
        node.horizon = horizon(graph, node);
        graph.nodes.push_back(std::move(node));
    };
    for (std::uint32_t input = 0; input < 2; ++input) {
        Node atom;
        atom.steps = {{Opcode::input, input},
                      {Opcode::constant, rtamt::early::none, rtamt::early::none, random.number(0)},
                      {random.chance(50) ? Opcode::sub : Opcode::holds_ge, 0, 1}};
        add(atom);
    }
    Node both_inputs;
    both_inputs.steps = {{Opcode::input, 0}, {Opcode::input, 1}, {Opcode::sub, 0, 1}};
    add(both_inputs);
    constexpr Kind kinds[] = {Kind::both,  Kind::either,      Kind::least, Kind::greatest,
                              Kind::since, Kind::since_dense, Kind::held,  Kind::until};
    for (int i = 0; i < size; ++i) {
        const Kind kind = kinds[random.between(0, with_until ? 7 : 6)];
        Node node;
        node.kind = kind;
        node.a = pick(random, graph.nodes.size());
        if (kind == Kind::held) {
            node.low = node.high = -random.between(1, 4);
        } else if (kind == Kind::least || kind == Kind::greatest) {
            const Tick near = random.between(0, 4); // windows reach to one side only
            const Tick far = near + random.between(0, 5);
            const bool past = random.chance(50);
            node.low = past ? -far : near;
            node.high = past ? -near : far;
            if (past && random.chance(30)) node.low = -forever;
        } else {
            node.b = pick(random, graph.nodes.size());
        }
        add(node);
    }
    graph.check();
    return graph;
}

// How many ticks behind the last that is known values may still change, and are read.
inline std::size_t margin(const Graph& graph) {
    std::size_t sum = 2;
    for (const Node& node : graph.nodes) {
        if (node.low > -forever) sum += static_cast<std::size_t>(std::max<Tick>(0, -node.low));
        sum += static_cast<std::size_t>(node.high < 0 ? -node.high : node.high);
    }
    return 2 * sum;
}

inline Bounds window(const std::vector<Bounds>& column, const Node& node, Tick t) {
    const bool greatest = node.kind == Kind::greatest;
    Bounds sum = greatest ? Interval::bottom : Interval::top;
    const Tick begin = node.low <= -forever ? 0 : std::max<Tick>(0, t + node.low);
    for (Tick k = begin; k <= t + node.high; ++k) {
        const auto place = std::min(static_cast<std::size_t>(k), column.size() - 1);
        sum = greatest ? Interval::join(sum, column[place]) : Interval::meet(sum, column[place]);
    }
    return sum;
}

// The bounds of every node at `count` ticks.
inline std::vector<std::vector<Bounds>> bounds(const Graph& graph, const Knowledge& known,
                                               std::size_t count) {
    const std::size_t n = count + margin(graph);
    std::vector<std::vector<Bounds>> columns;
    std::vector<Bounds> row(known.size());
    for (const Node& node : graph.nodes) {
        const auto at = [&](std::uint32_t ref, std::size_t t) {
            const Bounds value = columns[ref / 2][std::min(t, n - 1)];
            return (ref & 1U) != 0 ? Interval::neg(value) : value;
        };
        std::vector<Bounds> column(n);
        std::vector<Bounds> operand;
        if (node.kind == Kind::least || node.kind == Kind::greatest) {
            for (std::size_t t = 0; t < n; ++t)
                operand.push_back(at(node.a, t));
        }
        Bounds before = Interval::bottom;
        for (std::size_t i = 0; i < n; ++i) {
            const std::size_t t = node.kind == Kind::until ? n - 1 - i : i;
            switch (node.kind) {
            case Kind::atom: {
                for (std::size_t k = 0; k < known.size(); ++k)
                    row[k] = known[k][std::min(t, known[k].size() - 1)];
                std::vector<Bounds> results(node.steps.size());
                (void)rtamt::early::enclose(node.steps, row, results);
                column[t] = results.back();
                break;
            }
            case Kind::both:
                column[t] = Interval::meet(at(node.a, t), at(node.b, t));
                break;
            case Kind::either:
                column[t] = Interval::join(at(node.a, t), at(node.b, t));
                break;
            case Kind::held:
                column[t] = at(node.a, t - std::min(t, static_cast<std::size_t>(-node.low)));
                break;
            case Kind::until:
            case Kind::since:
                before = Interval::join(at(node.b, t), Interval::meet(at(node.a, t), before));
                column[t] = before;
                break;
            case Kind::since_dense:
                before = Interval::meet(at(node.a, t), Interval::join(at(node.b, t), before));
                column[t] = before;
                break;
            default:
                column[t] = window(operand, node, static_cast<Tick>(t));
            }
        }
        columns.push_back(std::move(column));
    }
    for (auto& column : columns)
        column.resize(count);
    return columns;
}

} // namespace early_oracle
