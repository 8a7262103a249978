// Bounds of every open instant for short windows: all are recomputed after each sample.
//
// A node has a column for each register (bounds_engine.hpp): its values from the first tick that
// may still change, or that a reader looks at, up to where the samples so far reach, and one value
// for all later ticks. A sample moves every column on by a tick and computes it from those of the
// operands.
//
// Cost: proportional to the length of all columns. Memory: the columns. Below a few dozen ticks
// that is less than to follow what changes, which costs more for some operators than for others
// (benchmarks/zone_bench.cpp). Samples must be in order, and operators must be those that take the
// least or the greatest of their operands; both engines give the same bounds.
#pragma once

#include "bound_changes.hpp"
#include "bounds_at_start.hpp"
#include "bounds_engine.hpp"
#include "graph.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace rtamt::early {

[[nodiscard]] inline bool is_unbounded(const Node& node) noexcept {
    return node.low <= -forever;
}

// Whether a value needs the one before it.
[[nodiscard]] inline bool is_recursive(const Node& node) noexcept {
    return node.kind == Kind::since || is_unbounded(node);
}

class ZoneEngine {
  public:
    // This engine is faster while it computes fewer ticks for a sample than it could, times this
    // factor, in the time that BoundsEngine needs.
    static constexpr Tick crossover = 1;

    // The engine for what is asked of a graph, unless it computes more ticks than `factor` allows
    // or the graph is not one for this engine. `start`: the items of the formula at the start of
    // the trace, if any.
    [[nodiscard]] static std::optional<ZoneEngine> of(const Graph& graph,
                                                      std::span<const std::uint32_t> outputs,
                                                      std::span<const Item> start,
                                                      std::span<const Bounds> ranges, Tick factor);

    // The values of all inputs at a tick later than all before; what lies between stays unknown.
    // What fails changes nothing.
    template <class Value>
    [[nodiscard]] std::optional<BoundsEngine::Failure> row(Tick t, std::span<const Value> values);

    // Bounds of an output at a tick that is not final for longer than the last one.
    [[nodiscard]] Bounds at(std::size_t output, Tick t) const noexcept;
    [[nodiscard]] Bounds at_start() const noexcept { return at_start_; }
    // The newest tick with samples, -1 before the first.
    [[nodiscard]] Tick newest() const noexcept { return newest_; }
    // Bounds of an output at ticks of the trace from `first` on, which were not dropped.
    [[nodiscard]] std::vector<Bounds> all_from(std::size_t output, Tick first) const;
    void drop_before(std::size_t output, Tick t);

    // What the last row changed of an output up to its tick.
    [[nodiscard]] std::vector<BoundChange> changes(std::size_t output) const;

    // The same engine as if later samples had these bounds.
    [[nodiscard]] ZoneEngine
    supposed(std::span<const BoundsEngine::Supposition> suppositions) const;

    // The same engine after the end of the trace, which cuts windows.
    [[nodiscard]] ZoneEngine ended() const;

    // The first tick that changes() reports of an output.
    [[nodiscard]] Tick first_change(std::size_t output) const;

    [[nodiscard]] std::size_t bytes() const noexcept;
    void transfer(Snapshot& snapshot);

  private:
    // From tick `first` on, of each register; `rest` is the value of all later ticks.
    struct Column {
        Tick first = 0;
        std::array<std::vector<double>, 2> values;
        std::array<double, 2> rest{-infinity, -infinity};
        std::array<double, 2> before{}; // of recursions, the value before the first tick

        [[nodiscard]] Tick end() const noexcept { return first + std::ssize(values[0]); }
        [[nodiscard]] double at(int reg, Tick t) const noexcept {
            const auto& known = values[static_cast<std::size_t>(reg)];
            const auto place = static_cast<std::size_t>(t - first);
            return place < known.size() ? known[place] : rest[static_cast<std::size_t>(reg)];
        }
    };
    // How far a column reaches behind and ahead of the newest sample.
    struct Reach {
        Tick behind = 0;
        Tick ahead = 0;
    };

    Graph graph_;
    std::vector<std::uint32_t> outputs_;
    std::optional<Item> start_;
    std::vector<Bounds> ranges_;
    std::vector<Reach> reach_;
    std::vector<Column> columns_;
    std::vector<Column> before_;                  // of outputs, before the last row
    std::vector<std::vector<BoundChange>> final_; // of outputs, the runs before their columns
    std::vector<Bounds> results_;
    std::vector<double> exact_;
    std::vector<Bounds> bounds_;
    std::array<std::vector<double>, 2> scratch_;
    Bounds at_start_ = bounds::anything;
    Tick newest_ = -1;
    Tick newest_before_ = -1;
    bool recursive_ = false;
    bool ended_ = false;

    ZoneEngine(const Graph& graph, std::span<const std::uint32_t> outputs,
               std::span<const Item> start, std::span<const Bounds> ranges);

    [[nodiscard]] Tick ticks_to_follow(const Node& node) const noexcept;
    [[nodiscard]] bool fits(Tick factor);
    void append(std::span<const Bounds> results);
    void skip(Tick t);
    void compute();
    template <bool up>
    void compute(std::size_t index, int reg);
    [[nodiscard]] double rest_of(std::uint32_t ref, int reg) const noexcept;
    [[nodiscard]] const double* read(std::uint32_t ref, int reg, Tick l, std::size_t n,
                                     double empty, std::size_t scratch);
    [[nodiscard]] double* copied(std::uint32_t ref, int reg, Tick l, std::size_t n, double empty,
                                 std::size_t scratch = 0);
    static void add_runs(std::vector<BoundChange>& runs, const Column& column, std::uint32_t ref,
                         Tick l, Tick r);
    [[nodiscard]] static Bounds bounds_of(const Column& column, std::uint32_t ref, Tick t) noexcept;
};

} // namespace rtamt::early
