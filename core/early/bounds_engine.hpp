// Bounds of every node of a graph at every tick, from whatever is known of the inputs by now.
//
// Register 0 of a node holds its lower bounds L, register 1 its negated upper bounds -U. As
// knowledge grows both only rise, so one set of kernels serves both: what takes the greatest in the
// one takes the least in the other. A node reports changes to its readers in pieces, runs with one
// old and one new value, and only these are examined: knowledge may arrive in any order.
//
// Cost: proportional to the pieces, independent of bounds. Memory: the runs that are still needed.
//
// Recomputing all open ticks after each sample is faster for short windows of samples in order: see
// zone_engine.hpp.
#pragma once

#include "graph.hpp"
#include "sliding.hpp"
#include "window_sums.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace rtamt::early {

struct Piece {
    Tick l;
    Tick r;
    double old;
    double now;
};

using Registers = std::array<Runs, 2>;

class BoundsEngine {
  public:
    // An operation without a value: the step of a node, at a tick.
    struct Failure {
        std::uint32_t node;
        std::uint32_t step;
        Tick tick;
    };

    // How knowledge comes: by row() alone, by late_row() alone, or by learn() alone.
    enum class Arrival : std::uint8_t { rows, late_rows, pieces };

    // `ranges`: what is known of each input before it is seen.
    BoundsEngine(Graph graph, std::vector<Bounds> ranges, Arrival arrival);

    // The values of all inputs at a tick later than all before; they are final.
    // What fails changes nothing.
    [[nodiscard]] std::optional<Failure> row(Tick t, std::span<const double> values);
    [[nodiscard]] std::optional<Failure> row(Tick t, std::span<const Bounds> values);

    // All that is known of all inputs at a tick in any order, within what was known before, where
    // it has changed for some inputs.
    [[nodiscard]] std::optional<Failure> late_row(Tick t, std::span<const Bounds> values,
                                                  std::span<const std::uint32_t> changed);

    // Whether all atoms have a value for such a row, which late_row() then takes whenever it comes.
    [[nodiscard]] bool is_defined(std::span<const Bounds> values) noexcept;

    // `last`: by node, the last tick that others than nodes will ever ask for, -1 for none. What
    // nothing reads is not followed.
    void limit(std::span<const Tick> last);

    // Up to which tick all inputs are known as well as they will ever be, from the next change on;
    // for what is given to learn().
    void settle_inputs(Tick tick) noexcept {
        complete_before_ = complete_;
        complete_ = tick;
    }

    // The same now, while nothing else changes: what turns out to have no value, which leaves
    // everything as it was.
    [[nodiscard]] std::optional<Failure> close_inputs(Tick tick) noexcept;

    // The first operation without a value in what reads no input.
    [[nodiscard]] std::optional<Failure> wrong_constant();

    // Knowledge of inputs at [l, r], within what was known before.
    struct Observation {
        std::uint32_t input;
        Tick l;
        Tick r;
        Bounds bounds;
    };
    // `newest`: the tick of the newest sample. `ended`: no more will arrive, and every input holds
    // its last value.
    [[nodiscard]] std::optional<Failure> learn(std::span<const Observation> observations,
                                               Tick newest, bool ended = false);

    // The nodes that others read for ever when the trace ends.
    void find_beyond(std::span<const std::uint32_t> read_forever);

    // Whether revert() takes back the last change too.
    void keep_undo(bool keeps) noexcept { keeps_undo_ = keeps; }

    // What is supposed of all inputs at [l, r], where nothing is known of them but their ranges. It
    // holds until revert(), with which everything is as it was before.
    struct Supposition {
        Tick l;
        Tick r;
        std::vector<Bounds> row;
    };
    [[nodiscard]] std::optional<Failure> suppose(std::span<const Supposition> suppositions);
    // The same of single inputs, where samples may be late.
    [[nodiscard]] std::optional<Failure> suppose(std::span<const Observation> observations);
    void revert();

    // What was learned of an input.
    [[nodiscard]] Bounds known(std::uint32_t input, Tick t) const noexcept;

    // Bounds of what a reference points to, at a tick that is still needed.
    [[nodiscard]] Bounds at(std::uint32_t ref, Tick t) const noexcept;

    // What the last change raised that was not taken back.
    [[nodiscard]] const std::vector<Piece>& new_data(std::uint32_t ref, int reg) const noexcept {
        return nodes_[ref / 2].out[change_][static_cast<std::size_t>(reg) ^ (ref & 1U)];
    }
    [[nodiscard]] const Runs& runs(std::uint32_t ref, int reg) const noexcept {
        return nodes_[ref / 2].own[static_cast<std::size_t>(reg) ^ (ref & 1U)];
    }
    // Whether an atom reads an input.
    [[nodiscard]] bool reads(std::uint32_t ref, std::uint32_t input) const noexcept {
        return std::ranges::binary_search(readers_[input], ref / 2);
    }
    [[nodiscard]] Tick horizon(std::uint32_t ref) const noexcept {
        return graph_.nodes[ref / 2].horizon;
    }
    // The sum of the bounds of all windows, without those that have no end: how far from a sample a
    // value may be that it changes, and that others do not share from there on.
    [[nodiscard]] Tick reach() const noexcept;
    // Whether an operation may have no value.
    [[nodiscard]] bool may_fail() const noexcept { return partial_; }
    // Whether operations that may have no value read more than one tick, or the start of the trace.
    [[nodiscard]] bool reads_start() const noexcept { return fallible_; }
    // The newest tick with samples, -1 before the first.
    [[nodiscard]] Tick seen() const noexcept { return seen_; }
    [[nodiscard]] const Graph& graph() const noexcept { return graph_; }
    [[nodiscard]] std::size_t size() const noexcept { return nodes_.size(); }
    [[nodiscard]] std::size_t inputs() const noexcept { return graph_.inputs; }

    // No sample will arrive at or before `closed`. `wanted`: by node, the first tick that is still
    // required by others than nodes. Drops what nothing needs.
    void settle(Tick closed, std::span<const Tick> wanted);

    // The bounds of a reference at every tick from the first that is held, when the trace ends just
    // before `end`, which cuts windows.
    struct Rest {
        Tick first;
        std::vector<Bounds> bounds;
    };
    // `failure`: what has no value then.
    [[nodiscard]] std::vector<Rest> ended(std::span<const std::uint32_t> refs, Tick end,
                                          std::optional<Failure>* failure = nullptr) const;

    [[nodiscard]] std::size_t bytes() const noexcept;

    void transfer(Snapshot& snapshot);

  private:
    struct State {
        Registers own;
        std::array<std::array<std::vector<Piece>, 2>, 2> out; // of two changes: see change_
        Tick from = 0;     // the first tick that may still change and is needed
        Tick keep = 0;     // the first tick that anybody reads
        Tick to = forever; // the last tick that anybody will read
        Tick beyond = 0;   // how many ticks behind the last sample it is read when the trace ends
        // The first tick without a value, which may never be reached: for operands that are known
        // exactly, and for any, by which step.
        struct Undefined {
            Tick exact = forever;
            Tick any = forever;
            std::uint32_t step = 0;
        };
        Undefined undefined;
        Undefined undefined_before; // the last change
        // Of what this change made an error, the first step, and the first tick of that.
        std::uint32_t wrong = none;
        Tick wrong_at = forever;
        // Of windows over an atom that learns from rows, in the register that takes the least: the
        // values of the atom up to a tick; `unread` where they are not known, and how many pieces
        // to wait until they are read.
        Sliding values{false};
        Tick slid = -1;
        Tick wait = 0;
    };
    static constexpr Tick unread = -2;
    struct Undo {
        Runs* runs;
        Tick l;
        Tick r;
        double old;
    };
    struct UndoInput {
        std::uint32_t input;
        StepMap<Bounds>::Run before;
    };

    Graph graph_;
    std::vector<Bounds> ranges_;
    std::vector<bool> truths_; // by node
    bool partial_ = false;     // an operation may have no value
    bool fallible_ = false;    // the same of nodes that are computed behind the atoms of a row
    bool awaited_ = false;     // one has none somewhere, or had: see State::undefined
    std::vector<State> nodes_;
    std::size_t change_ = 0; // which of two the last change is; the other is that before
    std::vector<std::uint32_t> atoms_;
    std::vector<StepMap<Bounds>> inputs_;             // what was learned of them
    std::vector<std::vector<std::uint32_t>> readers_; // the atoms that read an input
    std::vector<Undo> journal_;                       // of a change that may fail
    std::vector<UndoInput> input_journal_;            // the same of inputs
    bool journaling_ = false;
    bool of_row_ = false; // what changes is a row
    bool keeps_undo_ = false;
    std::vector<double> exact_;                // results of steps
    std::vector<Bounds> bounds_;               // results of steps
    std::vector<Bounds> results_;              // of atoms in a row
    std::vector<double> numbers_;              // a row of numbers
    std::vector<std::uint32_t> touched_;       // the atoms of a row
    std::vector<Bounds> row_;                  // knowledge of the inputs at a tick
    Tick seen_ = -1;                           // the newest tick with samples
    Tick seen_before_ = -1;                    // the last change
    Tick summed_ = -1;                         // the newest tick with samples, supposed ones too
    Tick complete_ = -1;                       // up to where all inputs are as well known as ever
    Tick complete_before_ = -1;                // the last change
    bool ended_ = false;                       // no more samples will arrive
    std::vector<WindowSums> sums_;             // by node, of sums
    std::vector<std::pair<Tick, Tick>> spans_; // where a sum may have changed

    [[nodiscard]] bool may_fail(const Node& node) const noexcept;
    [[nodiscard]] const Node& node(std::size_t i) const noexcept { return graph_.nodes[i]; }
    void know(std::span<const Observation> observations);
    [[nodiscard]] std::optional<Failure> attempt(std::optional<Failure> failure);
    void begin(Tick newest) noexcept;
    void clear() noexcept;

    // inputs.cpp
    template <class Value>
    [[nodiscard]] std::optional<Failure> take(Tick t, std::span<const Value> values);
    template <class Value>
    [[nodiscard]] std::optional<Failure> put(Tick t, std::span<const Value> values,
                                             std::span<const std::uint32_t> atoms);
    void assess(std::uint32_t index, Tick l, Tick r, bool supposed);
    void relearn(std::span<const Observation> observations, bool supposed);
    void relearn(std::uint32_t index, Tick l, Tick r, bool supposed = false);
    void remap(std::uint32_t index, Tick l, Tick r);
    [[nodiscard]] std::optional<Failure> propagate(bool first);
    void lift_empty(std::uint32_t index);

    // undefined.cpp
    [[nodiscard]] bool reached(std::uint32_t index, Tick t) const noexcept {
        return t < forever && t <= (ended_ ? plus(seen_, nodes_[index].beyond) : seen_);
    }
    [[nodiscard]] bool is_error(std::uint32_t index, Tick t, bool exact) const noexcept;
    [[nodiscard]] std::optional<Failure> fails(std::uint32_t index) const noexcept;
    void has_no_value(std::uint32_t index, std::uint32_t step, Tick t, bool exact) noexcept;

    // sums.cpp
    void lift(State& state, Tick l, Tick r, const Bounds& now);
    [[nodiscard]] std::optional<Failure> add_up(std::uint32_t index, bool first);
    [[nodiscard]] std::optional<Failure> add_windows(std::uint32_t index, Tick t, Tick r);
    [[nodiscard]] std::optional<Failure> add_all(std::uint32_t index, Tick t);

    // kernels.cpp: all other nodes, a register at a time
    void report(State& state, int reg, const Run& run, double now);
    void change(State& state, int reg, Runs::Place place, Run run, double now);
    void change(State& state, int reg, Run run, double now);
    void lift(State& state, int reg, Tick l, Tick r, double now);
    void append(State& state, int reg, Tick t, double now);
    void raise_end(State& state, int reg, Tick l, Tick r, double now);
    void pass(std::uint32_t index, int reg);
    void combine(std::uint32_t index, int reg, bool up);
    void slide(std::uint32_t index, int reg, bool up);
    void rank(std::uint32_t index, int reg, bool up);
    void pulses(std::uint32_t index, int reg);
    void slide_least(State& state, int reg, const Node& node, const Runs& operand, Piece piece);
    void run_least(State& state, int reg, const Node& node, const Runs& operand, Piece piece);
    void slide_truth(State& state, int reg, const Node& node, const Runs& operand, Piece piece);
    void slide_piece(State& state, int reg, const Node& node, const Runs& operand, Piece piece);
    template <bool up>
    void until(State& state, int reg, const Runs& hold, const Runs& goal, Tick l, Tick r);
    template <bool up, bool dense>
    void since(State& state, int reg, const Runs& hold, const Runs& goal, Tick l, Tick r);

    // windows_of_rows.cpp: windows over atoms that learn from rows
    [[nodiscard]] std::optional<Failure> propagate_row();
    void raise_of_row(State& state, int reg, const Node& node, Piece piece);
    void slide_of_row(State& state, int reg, const Node& node, const Runs& operand, Piece piece);
    void add_value(State& state, int reg, const Node& node, Tick t, double value);
    void add_values(State& state, int reg, const Node& node, const Runs& operand);
    void read_values(State& state, const Node& node, const Runs& operand);
    [[nodiscard]] Tick passed(const Node& node) const noexcept;
};

} // namespace rtamt::early
