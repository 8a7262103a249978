// Samples of step signals, each with its own times, and what of the signals they make known.
//
// A sample holds its value until the next one of its input. Its own tick is known at once; what
// follows, as far as no other sample of the input can arrive: up to its newest sample if
// samples of an input are in order, else up to the closed tick. The trace starts at the latest
// first sample of an input, when no earlier one can arrive; samples are kept until then.
//
// Cost: a search for each sample; late samples move those after them. Memory: the samples
// behind what is known, and one more for each input.
#pragma once

#include "bounds_engine.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace rtamt::early {

class Samples {
  public:
    // `lateness`: by how many ticks a sample may be older than the newest one of any input; none:
    // the samples of an input are in order.
    // `waits`: whether the trace starts at release() or later.
    Samples(std::vector<Bounds> ranges, std::optional<Tick> lateness, bool waits = false);

    // Times are less far from 0, and a trace is shorter.
    static constexpr Tick farthest = std::numeric_limits<Tick>::max() / 2;
    static constexpr Tick longest = forever / 2;

    // The sample of an input, at a time that it may have.
    [[nodiscard]] bool may_come(std::uint32_t input, Tick time) const noexcept;
    void add(std::uint32_t input, Tick time, const Bounds& bounds);

    // A sample of another trace, of this time, has come.
    void reach(Tick time) noexcept;

    // No sample at or before a time will arrive; none at all.
    void close(Tick time) noexcept;
    void finish() noexcept { close(at_end); }
    [[nodiscard]] bool ended() const noexcept { return now_.closed == at_end; }

    // Whether the trace starts, or would if it did not wait.
    [[nodiscard]] bool ready() const noexcept { return first_start().has_value(); }
    void release() noexcept;

    // Takes everything back since the last commit, or forgets how.
    void rollback() noexcept;
    void commit();
    // The same where what has been added is not collected yet; samples may be late.
    void postpone();

    // What has become known since it was last collected; ticks count from the start of the trace.
    void collect(std::vector<BoundsEngine::Observation>& observations);
    // The same up to the closed tick.
    void collect_closed(std::vector<BoundsEngine::Observation>& observations);
    // Before the start: the own ticks of samples from a time on, of all that are before another
    // time, and of those added since the last commit. Ticks count from `origin`.
    void collect_first(Tick origin, Tick from, Tick before,
                       std::vector<BoundsEngine::Observation>& observations) const;

    // The bounds of an input at a time, as far as they are known.
    [[nodiscard]] Bounds known(std::uint32_t input, Tick time) const noexcept;

    [[nodiscard]] std::optional<Tick> start() const noexcept { return now_.start; }
    // Before the start: where it is, unless an earlier sample comes. None while an input has none.
    [[nodiscard]] std::optional<Tick> latest_first() const noexcept;
    // The newest sample of any input, and of one.
    [[nodiscard]] std::optional<Tick> newest() const noexcept { return now_.newest; }
    [[nodiscard]] std::optional<Tick> newest(std::uint32_t input) const noexcept;
    // No sample at or before this time will arrive.
    [[nodiscard]] std::optional<Tick> closed() const noexcept;
    // Up to which tick of the trace each input is known.
    [[nodiscard]] const std::vector<Tick>& settled() const noexcept { return settled_; }

    // Whether samples of an input may come in any order.
    [[nodiscard]] bool late() const noexcept { return lateness_.has_value(); }
    // What is known of each input before it is seen.
    [[nodiscard]] const std::vector<Bounds>& ranges() const noexcept { return ranges_; }
    [[nodiscard]] std::size_t inputs() const noexcept { return inputs_.size(); }
    [[nodiscard]] std::size_t bytes() const noexcept;

    void transfer(Snapshot& snapshot);

  private:
    struct Sample {
        Tick time = 0;
        Bounds bounds{};
        bool collected = false; // its own tick, before what follows is known
    };
    struct Added {
        std::uint32_t input = 0;
        Tick time = 0;
        std::optional<Sample> before; // that was there
    };
    static constexpr Tick never = std::numeric_limits<Tick>::min();
    static constexpr Tick at_end = std::numeric_limits<Tick>::max();
    struct State {
        std::optional<Tick> start;
        std::optional<Tick> newest;
        Tick closed = never;
        bool waits = false;
    };
    using Column = std::vector<Sample>; // by time

    std::vector<Bounds> ranges_;
    std::optional<Tick> lateness_;
    std::vector<Column> inputs_;
    std::vector<Tick> settled_;
    State now_;
    State committed_;
    std::vector<Tick> committed_settled_;
    std::vector<Added> added_; // since the last commit
    // Samples whose own ticks have not been collected; some of what is closed by now.
    std::vector<std::pair<std::uint32_t, Tick>> waiting_;
    std::size_t many_ = 0; // so many that those are forgotten

    [[nodiscard]] static std::size_t after(const Column& column, Tick time) noexcept;
    [[nodiscard]] Tick relative(Tick time) const noexcept;
    [[nodiscard]] Tick absolute(Tick tick) const noexcept;
    [[nodiscard]] Tick certain(std::size_t input) const noexcept;
    [[nodiscard]] std::optional<Tick> first_start() const noexcept;
    void find_start() noexcept;
    void keep();
};

} // namespace rtamt::early
