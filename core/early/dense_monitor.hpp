// Verdicts or bounds before the horizon in dense time: samples of any inputs in, runs of ticks out.
//
// Times are ticks of the caller; the engine counts from the start of the trace. An instant of which
// something is known is reported when a sample of any input has reached it.
//
// Samples that may be late change bounds when no sample at their ticks or before can arrive any
// more, or when somebody reads bounds. Without a reader the engine thus takes them in the order of
// time, however they come, and each of them once. A reader of changes gets those of the last call:
// all others are taken before it. Operations that may have no value are computed at once, as they
// may be an error.
//
// Cost: that of the engine. Memory: its runs, and samples as Samples keeps them.
#pragma once

#include "bounds_at_start.hpp"
#include "bounds_engine.hpp"
#include "causation.hpp"
#include "dense_output.hpp"
#include "dense_rehearsal.hpp"
#include "samples.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <variant>
#include <vector>

namespace rtamt::early {

struct DenseSettings {
    std::vector<std::uint32_t> outputs; // references
    std::vector<Item> at_start;         // of the bounds at the start; none: not reported
    std::vector<Bounds> ranges;         // of the inputs
    std::optional<Tick> lateness;       // see Samples
    bool decides = false;               // verdicts; if not, bounds
    std::optional<CauseGraph> causes;   // what samples cause, in addition to bounds
    bool several = false;               // whether what has been taken may be rejected
    bool waits = false;                 // whether the trace starts when it is released
};

class DenseMonitor {
  public:
    using Failure = BoundsEngine::Failure;

    DenseMonitor(Graph graph, DenseSettings settings);

    // The sample of an input.
    struct Given {
        std::uint32_t input;
        Bounds bounds;
    };
    // Samples at one time, which they may have. What fails changes nothing.
    [[nodiscard]] std::optional<Failure> take(Tick time, std::span<const Given> given);
    // No sample at or before a time will arrive.
    [[nodiscard]] std::optional<Failure> watermark(Tick time);
    // The trace ends: every signal holds its last value.
    [[nodiscard]] std::optional<Failure> finish();

    // The same in steps, where several monitors take what comes or none of them does; for settings
    // of which `several` is set. First samples, a watermark or the end. `newest`: the newest sample
    // of any monitor.
    void stage(Tick time, std::span<const Given> given, std::optional<Tick> newest);
    void stage_watermark(Tick time);
    void stage_finish();
    // Lets a trace start that waits, which it would by now.
    [[nodiscard]] bool ready() const noexcept { return samples_.ready(); }
    void release() noexcept { samples_.release(); }
    // Then what follows from it, unless that fails, which unstages it; and then accept or reject.
    [[nodiscard]] std::optional<Failure> attempt();
    void accept();
    void reject();
    void unstage() noexcept { samples_.rollback(); }

    [[nodiscard]] const Samples& samples() const noexcept { return samples_; }
    [[nodiscard]] bool finished() const noexcept { return finished_; }
    [[nodiscard]] std::size_t outputs() const noexcept { return outputs_.size(); }

    // Of an output, what the last call decided, or changed: in order, and in the caller's ticks.
    [[nodiscard]] const std::vector<Decision>& decisions(std::size_t output) const noexcept {
        return outputs_[output].decisions();
    }
    [[nodiscard]] std::vector<BoundChange> changes(std::size_t output);

    // The bounds at the start, where they are computed.
    [[nodiscard]] std::optional<Bounds> at_start();

    // What the last call caused, where that is required: at the start of the trace, of an output
    // there or at a later time, and at all times, in order.
    [[nodiscard]] Bounds caused_at_start() const noexcept {
        return causes_ ? causes_->at_start() : bounds::anything;
    }
    [[nodiscard]] std::optional<Bounds> caused(std::size_t output, std::optional<Tick> time) const;
    [[nodiscard]] std::vector<BoundChange> caused(std::size_t output) const;
    // The same up to a tick of the trace, which may be behind its end.
    [[nodiscard]] std::vector<BoundChange> caused_up_to(std::size_t output, Tick last) const;

    // An output, or none for the start, at a tick that is held, if an input had these bounds from a
    // time on: behind its newest sample, and up to the next one of them.
    struct Supposed {
        std::uint32_t input;
        Tick from;
        Bounds bounds;
    };
    [[nodiscard]] std::variant<Bounds, Failure> suppose(std::optional<std::size_t> output,
                                                        Tick time, std::span<const Supposed> later);

    // The bounds of an output at a tick; none before the first that is held, or before the trace
    // has started. All of them, up to the newest sample. What is final is held for some more calls.
    [[nodiscard]] std::optional<Bounds> at(std::size_t output, Tick time);
    [[nodiscard]] std::vector<BoundChange> runs(std::size_t output);
    [[nodiscard]] std::optional<Tick> held(std::size_t output) const noexcept;

    // What an output is in ticks from the start of the trace on.
    [[nodiscard]] const BoundsEngine& engine() const noexcept { return engine_; }
    [[nodiscard]] std::uint32_t ref(std::size_t output) const noexcept {
        return outputs_[output].ref();
    }

    // The last tick up to which all inputs are as well known as they will ever be.
    [[nodiscard]] std::optional<Tick> complete() const noexcept;
    // None before it has started.
    [[nodiscard]] std::optional<Tick> trace_start() const noexcept {
        return begun_ ? samples_.start() : std::nullopt;
    }

    [[nodiscard]] std::size_t bytes() const noexcept;

    void transfer(Snapshot& snapshot);

  private:
    BoundsEngine engine_;
    Samples samples_;
    DenseRehearsal rehearsal_; // of the samples until the trace starts
    std::vector<DenseOutput> outputs_;
    std::optional<BoundsAtStart> at_start_;
    std::optional<Causes> causes_;
    std::vector<Tick> wanted_; // by node
    std::vector<BoundsEngine::Observation> observations_;
    std::int64_t calls_ = 0;
    Tick closed_ = -1; // the last tick of the trace before its end that is final
    bool begun_ = false;
    bool finished_ = false;
    bool postpones_ = false;
    // Of what is staged: its date, the newest sample before, and whether the trace begins with it.
    Tick at_ = 0;
    std::optional<Tick> before_;
    bool begins_ = false;
    // The samples of the last call, if they are postponed, and whether others before are as well.
    std::vector<Given> postponed_;
    bool others_ = false;

    [[nodiscard]] Tick start() const noexcept { return samples_.start().value_or(0); }
    [[nodiscard]] Tick newest() const noexcept { return *samples_.newest() - start(); }
    [[nodiscard]] std::optional<Failure> learn();
    void postpone(Tick time, std::span<const Given> given);
    void take_closed();
    void catch_up();
    void apply();
    void report();
    void settle();
};

} // namespace rtamt::early
