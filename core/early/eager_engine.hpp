// What is decided of every node of a graph of truth values, at every tick, from samples in order.
//
// A node tells its readers what became decided of it, run by run, and only these are examined, with
// the rules of BoundsEngine where values are infinite: both decide the same ticks with the same
// sample. But here a value has one register, of two bits, and never changes once it is decided, so
// that every run which a sample passes over is one less for later ones.
//
// Cost: amortised constant for each node and sample but for searches of runs, whatever the bounds
// of windows. Memory: the runs that are still needed.
#pragma once

#include "bounds_engine.hpp"
#include "kleene_runs.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace rtamt::early {

class EagerEngine {
  public:
    using Failure = BoundsEngine::Failure;
    using DecidedRun = KleeneRuns::Run;

    // The engine of a graph, if all its values are those of truth and its nodes are atoms, of which
    // unseen samples have a value, and operators that take the least or the greatest of theirs.
    [[nodiscard]] static std::optional<EagerEngine> of(const Graph& graph,
                                                       std::span<const Bounds> ranges);

    // The values or bounds of all inputs at a tick later than all before. What fails changes
    // nothing.
    template <class Value>
    [[nodiscard]] std::optional<Failure> row(Tick t, std::span<const Value> values);

    // What a reference points to around a tick that is still needed.
    [[nodiscard]] DecidedRun at(std::uint32_t ref, Tick t) const noexcept {
        DecidedRun run = states_[ref / 2].own.at(t);
        run.value = through(ref, run.value);
        return run;
    }
    [[nodiscard]] Bounds bounds(std::uint32_t ref, Tick t) const noexcept;
    // What the last row decided of a node, not of its negation.
    [[nodiscard]] const std::vector<Decided>& decided(std::uint32_t ref) const noexcept {
        return states_[ref / 2].decided;
    }

    // As BoundsEngine does.
    void settle(Tick closed, std::span<const Tick> wanted);
    [[nodiscard]] std::vector<BoundsEngine::Rest> ended(std::span<const std::uint32_t> refs,
                                                        Tick end) const;

    [[nodiscard]] std::size_t bytes() const noexcept;

    void transfer(Snapshot& snapshot);

  private:
    struct State {
        KleeneRuns own;
        std::vector<Decided> decided; // by the last row
        Tick from = 0;                // the first tick that may still be decided and is needed
        Tick keep = 0;                // the first tick that anybody reads
    };
    // An atom that compares an input with a number, which needs no steps.
    struct Threshold {
        double number;
        std::uint32_t node;
        std::uint32_t input;
        bool strict;
        bool less; // whether the number is compared with the input
        bool negated;
    };

    Graph graph_;
    std::vector<State> states_;
    std::vector<Threshold> thresholds_;
    std::vector<std::uint32_t> others_; // atoms
    std::vector<std::uint32_t> inner_;  // nodes that are no atoms
    std::vector<Kleene> values_;        // of atoms in a row
    std::vector<double> exact_;         // results of steps
    std::vector<Bounds> bounds_;        // results of steps

    explicit EagerEngine(const Graph& graph);

    [[nodiscard]] const Node& node(std::size_t i) const noexcept { return graph_.nodes[i]; }
    // What a reference makes of a value of its node.
    [[nodiscard]] static Kleene through(std::uint32_t ref, Kleene value) noexcept {
        return (ref & 1U) != 0 ? flipped(value) : value;
    }
    [[nodiscard]] static std::optional<Threshold> threshold(const Node& node, std::uint32_t index);
    void fill(State& state, Tick l, Tick r, Kleene value) const;
    void decide_empty(const Node& node, State& state) const;
    void propagate();
    void combine(const Node& node, State& state) const;
    void slide(const Node& node, State& state) const;
    void until(const Node& node, State& state, Tick l, Tick r) const;
    void since(const Node& node, State& state, Tick l, Tick r) const;
};

} // namespace rtamt::early
