// Verdicts or bounds before the horizon in discrete time: samples a period apart in, runs of ticks
// out.
//
// Ticks are indices of samples, of which the first is 0. Where windows are short, bounds at all
// open ticks are recomputed after each sample (zone_engine.hpp); else changes are propagated, for
// verdicts those of truth values (eager_engine.hpp).
//
// A sample that may be late changes bounds when it cannot be preceded any more, or when somebody
// reads them: what nobody reads is computed in order (postponed.cpp).
//
// Cost: that of the engine. Memory: its runs, and times as SampleTimes keeps them.
#pragma once

#include "bound_changes.hpp"
#include "bounds_at_start.hpp"
#include "bounds_engine.hpp"
#include "causation.hpp"
#include "eager_engine.hpp"
#include "eager_verdicts.hpp"
#include "late_rows.hpp"
#include "postponed.hpp"
#include "sample_times.hpp"
#include "zone_engine.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <variant>
#include <vector>

namespace rtamt::early {

struct DiscreteSettings {
    std::vector<std::uint32_t> outputs; // references
    std::vector<Item> at_start;         // of the bounds at the start; none: not reported
    std::vector<Bounds> ranges;         // of the inputs
    double period = 0;
    double tolerance = 0;              // in periods
    std::optional<Tick> lateness;      // by how many samples at most; none: samples are in order
    bool decides = false;              // verdicts; if not, bounds
    std::optional<CauseGraph> causes;  // what samples cause, in addition to bounds
    Tick zone = ZoneEngine::crossover; // the factor up to which bounds are recomputed
};

class DiscreteMonitor {
  public:
    using Failure = BoundsEngine::Failure;
    using Observation = BoundsEngine::Observation;
    using Supposition = BoundsEngine::Supposition;

    DiscreteMonitor(const Graph& graph, DiscreteSettings settings);

    // The index of a time, if it is on the grid of the samples.
    [[nodiscard]] std::optional<Tick> place(double time) const noexcept {
        return times_.place(time);
    }
    // Gives the first sample an index, so that earlier ones may follow. Returns false, with nothing
    // done, where what has no value depends on the start of the trace.
    bool begin_at(Tick index) noexcept;

    // Whether a sample at this time is in order.
    [[nodiscard]] bool in_order(Tick index) const noexcept;

    // The values or bounds of all inputs at the next sample in order. What fails changes
    // nothing.
    template <class Value>
    [[nodiscard]] std::optional<Failure> row(Tick index, double time, std::span<const Value> row);
    // Those of some inputs at any sample after `closed`, within what is known of them.
    [[nodiscard]] std::optional<Failure> learn(Tick index, double time,
                                               std::span<const Observation> observations);
    // No sample at or before a time will arrive.
    [[nodiscard]] std::optional<Failure> watermark(double time);

    // What the end of the trace makes of bounds: of each output those from a tick on, and those at
    // the start.
    struct Rest {
        Tick first;
        std::vector<Bounds> bounds;
    };
    struct End {
        std::vector<Rest> outputs;
        std::optional<Bounds> at_start;
    };
    // The trace ends. Verdicts are then in decisions(), and there are no bounds.
    [[nodiscard]] std::variant<End, Failure> finish();

    // ---- results
    [[nodiscard]] std::size_t outputs() const noexcept { return outputs_.size(); }
    // Of an output, what the last call decided, or changed: in order.
    [[nodiscard]] const std::vector<Decision>& decisions(std::size_t output) const noexcept {
        return news_[output];
    }
    [[nodiscard]] std::vector<BoundChange> changes(std::size_t output) const;
    // Whether such a run will not change any more.
    [[nodiscard]] bool is_final(std::size_t output, const BoundChange& run) const noexcept;
    [[nodiscard]] std::optional<Bounds> at_start() const;
    // Nothing where the tick is not held any more.
    [[nodiscard]] std::optional<Bounds> bounds(std::size_t output, Tick sample) const;
    // What the newest sample causes: at the start, of an output at a tick, and at all ticks.
    [[nodiscard]] bool causes() const noexcept { return causes_.has_value(); }
    [[nodiscard]] Bounds caused_at_start() const noexcept;
    [[nodiscard]] Bounds caused(std::size_t output, Tick sample) const;
    [[nodiscard]] std::vector<BoundChange> caused(std::size_t output) const;
    // The bounds of an output at a tick that is held, or of the formula at the start, if later
    // samples had these bounds.
    [[nodiscard]] std::variant<Bounds, Failure> supposed(std::optional<std::size_t> output,
                                                         Tick sample,
                                                         std::span<const Supposition> suppositions);

    [[nodiscard]] Bounds known(std::uint32_t input, Tick sample) const noexcept {
        return late_rows_ ? late_rows_->at(sample)[input] : ranges_[input];
    }
    [[nodiscard]] double time(Tick sample) const noexcept { return times_.at(sample); }
    // The first tick of an output that is held.
    [[nodiscard]] Tick held(std::size_t output) const noexcept;
    [[nodiscard]] double period() const noexcept { return times_.period(); }
    [[nodiscard]] std::int64_t samples() const noexcept { return samples_; }
    [[nodiscard]] Tick newest() const noexcept { return times_.newest(); }
    [[nodiscard]] double last_time() const noexcept { return times_.last(); }
    [[nodiscard]] double earliest() const noexcept { return times_.earliest(); }
    [[nodiscard]] Tick closed() const noexcept {
        return closed_;
    } // no sample up to here will arrive
    [[nodiscard]] bool late() const noexcept { return lateness_.has_value(); }
    [[nodiscard]] bool finished() const noexcept { return finished_; }
    [[nodiscard]] bool computes_zone() const noexcept { return zone_.has_value(); }
    [[nodiscard]] bool follows_truth() const noexcept { return eager_.has_value(); }
    [[nodiscard]] const std::vector<Bounds>& ranges() const noexcept { return ranges_; }

    [[nodiscard]] std::size_t bytes() const noexcept;

    // Drops what is not needed any more; before transfer() writes a state, which is then the same
    // whenever it was done last.
    void settle();
    void transfer(Snapshot& snapshot);

  private:
    // Of bounds, and of what no other one follows; it does not know what is postponed yet.
    mutable std::optional<BoundsEngine> engine_;
    std::optional<ZoneEngine> zone_;   // in its place where windows are short
    std::optional<EagerEngine> eager_; // in its place for verdicts of truth values
    std::vector<std::uint32_t> outputs_;
    std::vector<Tick> lags_;             // by output, until its values are final
    std::vector<EagerVerdicts> waiting_; // by output
    bool reports_start_;
    mutable std::optional<BoundsAtStart> at_start_; // of the first engine
    std::optional<Causes> causes_;
    SampleTimes times_;
    std::vector<Bounds> ranges_;
    std::optional<Tick> lateness_;
    std::optional<LateRows> late_rows_; // with a lateness
    std::vector<Bounds> row_;           // of a sample that may be late
    std::vector<std::uint32_t> given_;  // its inputs
    bool decides_;
    std::vector<std::vector<Decision>> news_;   // by output
    mutable std::vector<BoundChanges> changes_; // by output
    mutable bool unread_ = false;               // those of the last sample, before which the newest
    Tick before_ = -1;                          // was this one
    Tick first_ = 0;                            // of the trace; see begin_at()
    bool postpones_ = false;                    // samples that nothing reads
    mutable Postponed postponed_;
    std::vector<std::uint32_t> every_input_;
    std::vector<Tick> open_; // by output, the first tick without a verdict
    std::vector<Tick> kept_; // by output, the first tick whose bounds the end still gives
    std::vector<Tick> wanted_;
    Tick closed_ = -1;
    std::int64_t samples_ = 0;
    bool finished_ = false;

    [[nodiscard]] Tick closed_after(Tick index) const noexcept;
    [[nodiscard]] Tick final_up_to() const noexcept;
    [[nodiscard]] Tick lag(std::size_t output) const noexcept;
    [[nodiscard]] Tick held(std::size_t output, Tick closed) const noexcept;
    [[nodiscard]] Bounds followed(std::size_t output, Tick sample) const noexcept;
    void follow(const Graph& graph, DiscreteSettings settings);
    void advance(Tick index, double time, bool later = false);
    void note();
    void read_changes() const;
    void tidy();

    // postponed.cpp
    void take(Tick index, std::span<const Bounds> row, Tick closed) const;
    void take_closed();
    void catch_up() const;
    void decide_rest(std::span<const BoundsEngine::Rest> rests, Tick end);
};

} // namespace rtamt::early
