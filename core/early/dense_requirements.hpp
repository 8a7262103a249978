// Several requirements in dense time, each group of which reads its own variables.
//
// Such a group has its own trace, which starts when all its variables have started, and its own
// monitor. The result is the minimum of the requirements: at each instant of those that have
// started, from the first start on, once all have. It is kept by one more engine, whose inputs are
// the values of the groups, so that only what changes is looked at; at the start of the trace it is
// that of each requirement at its own start.
//
// Cost and memory: the sum over the groups; of one group alone those of its monitor.
#pragma once

#include "dense_monitor.hpp"
#include "dense_output.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <variant>
#include <vector>

namespace rtamt::early {

class DenseRequirements {
  public:
    struct Group {
        Graph graph;
        DenseSettings settings;            // with the ranges of its inputs
        std::vector<std::uint32_t> inputs; // which of all inputs its own are
    };
    // An output of a group.
    struct Place {
        std::uint32_t group;
        std::uint32_t output;
    };
    struct Failure {
        std::uint32_t group;
        BoundsEngine::Failure operation;
    };
    using Given = DenseMonitor::Given;
    using Supposed = DenseMonitor::Supposed;

    // `required`: how many groups, the first ones, have requirements. `outputs`: of the result, its
    // values in these groups, none if it is not reported; and of all others one place each.
    DenseRequirements(std::vector<Group> groups, std::size_t required,
                      const std::vector<std::vector<Place>>& outputs);

    [[nodiscard]] bool may_come(std::uint32_t input, Tick time) const noexcept;
    // What is known of an input at a time.
    [[nodiscard]] Bounds known(std::uint32_t input, Tick time) const noexcept;
    [[nodiscard]] std::optional<Tick> newest(std::uint32_t input) const noexcept;

    // As those of DenseMonitor, for which see there.
    [[nodiscard]] std::optional<Failure> take(Tick time, std::span<const Given> given);
    [[nodiscard]] std::optional<Failure> watermark(Tick time);
    [[nodiscard]] std::optional<Failure> finish();
    [[nodiscard]] std::optional<Tick> newest() const noexcept;
    [[nodiscard]] std::optional<Tick> closed() const noexcept;
    [[nodiscard]] std::optional<Tick> complete() const noexcept;
    [[nodiscard]] bool finished() const noexcept { return monitors_.front().finished(); }
    [[nodiscard]] std::size_t outputs() const noexcept { return outputs_.size(); }
    [[nodiscard]] const std::vector<Decision>& decisions(std::size_t output) const noexcept;
    [[nodiscard]] std::vector<BoundChange> changes(std::size_t output);
    [[nodiscard]] std::vector<BoundChange> runs(std::size_t output);
    [[nodiscard]] std::optional<Bounds> at(std::size_t output, Tick time);
    [[nodiscard]] std::optional<Tick> held(std::size_t output) const noexcept;
    [[nodiscard]] std::optional<Bounds> at_start();
    [[nodiscard]] Bounds caused_at_start();
    [[nodiscard]] std::optional<Bounds> caused(std::size_t output, std::optional<Tick> time) const;
    [[nodiscard]] std::vector<BoundChange> caused(std::size_t output) const;
    // None where nothing is held.
    [[nodiscard]] std::variant<std::optional<Bounds>, Failure>
    suppose(std::optional<std::size_t> output, Tick time, std::span<const Supposed> later);

    [[nodiscard]] std::size_t bytes() const noexcept;

    void transfer(Snapshot& snapshot);

  private:
    // The minimum of values of several groups, in ticks from the first start.
    struct Minimum {
        BoundsEngine engine;
        DenseOutput output;
        std::vector<Place> places;
        std::vector<Tick> wanted; // by node
        Tick start = 0;
        bool begun = false;
        std::int64_t calls = 0;
    };

    std::vector<DenseMonitor> monitors_; // by group
    std::vector<std::vector<std::uint32_t>> inputs_;
    std::vector<Place> homes_; // by input, one group that reads it, and which of its inputs it is
    std::size_t required_;
    std::vector<Place> outputs_;
    std::optional<Minimum> minimum_; // the first output, where it is not one of a group
    std::vector<Given> given_;
    std::vector<BoundsEngine::Observation> observations_;

    [[nodiscard]] bool is_minimum(std::size_t output) const noexcept {
        return minimum_.has_value() && output == 0;
    }
    [[nodiscard]] const DenseMonitor& of(std::size_t output) const noexcept {
        return monitors_[outputs_[output].group];
    }
    [[nodiscard]] DenseMonitor& of(std::size_t output) noexcept {
        return monitors_[outputs_[output].group];
    }
    template <class Stage>
    [[nodiscard]] std::optional<Failure> each(const Stage& stage);
    void follow(Tick at, std::optional<Tick> before);
    void observe(std::uint32_t place, bool begins);
    [[nodiscard]] std::array<Pieces, 2> caused_pieces() const;
};

} // namespace rtamt::early
