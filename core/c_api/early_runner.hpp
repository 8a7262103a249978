// A program whose outputs are bounds and verdict at the start of the trace, in discrete time.
//
// Its outputs are lower, upper, verdict (+inf or -inf, not known while it is open) and
// decided_since (seconds from the first sample to the one that decided). The instructions are
// inputs and constants alone: what runs is a graph (../early/graph.hpp), which the metadata carries
// as bytes, little endian:
//
//     u32, u32, u32   numbers of nodes, of items, and of those that are of the robustness; the last
//                     item is that of the truth
//     nodes, items    as in ../early/graph_bytes.hpp
//     ranges          none; or of each input f64 least, f64 greatest value: a sample outside is
//                     refused
//
// Step k has the meaning of instruction `inputs` + k, and a constant has its value.
#pragma once

#include "../early/bounds_at_start.hpp"
#include "../early/bounds_engine.hpp"
#include "runner.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace rtamt::c_api {

struct EarlyGraph {
    early::Graph graph;
    std::vector<early::Item> robustness;
    std::vector<early::Item> truth;
    std::vector<Bounds> ranges; // by input, or none

    // Throws std::invalid_argument with one sentence.
    [[nodiscard]] static EarlyGraph parse(const std::string& bytes, std::uint32_t inputs);

    // Gives constants the values of their instructions, which a parameter may have changed; throws
    // as parse does.
    void take_constants(const Program& program);
};

class EarlyRunner final : public SampledRunner {
  public:
    static constexpr std::size_t outputs = 4;

    EarlyRunner(Program program, double period, EarlyGraph graph);

    void step(const double* row, std::span<rtamt_value> known) override;
    void hold(std::span<const double> row, std::size_t count,
              std::span<rtamt_value> known) override;
    [[nodiscard]] std::int64_t samples() const noexcept override { return samples_; }
    [[nodiscard]] std::span<const Bounds> ranges() const noexcept override { return graph_.ranges; }

    [[nodiscard]] const Program& program() const noexcept override { return program_; }
    [[nodiscard]] bool finished() const noexcept override { return finished_; }
    [[nodiscard]] bool begun() const noexcept override { return samples_ != 0; }
    [[nodiscard]] std::optional<std::int64_t>
    known_until(std::size_t output) const noexcept override;
    void finish() override;
    void reset() override;
    void transfer(Snapshot& snapshot) override;

  private:
    Program program_;
    double period_;
    EarlyGraph graph_;
    early::BoundsEngine engine_;
    early::BoundsAtStart robustness_;
    early::BoundsAtStart truth_;
    std::vector<std::uint32_t> steps_before_; // by node
    std::vector<early::Tick> wanted_;
    Bounds bounds_{};
    std::int64_t samples_ = 0;
    std::int64_t decided_ = -1; // the sample that decided
    double verdict_ = 0.0;
    bool finished_ = false;

    void limit();
    void take(const double* row);
    void decide(const Bounds& truth) noexcept;
    void settle();
    [[nodiscard]] rtamt_value value(std::size_t output) const noexcept;
    void show(std::span<rtamt_value> known) const noexcept;
};

} // namespace rtamt::c_api
