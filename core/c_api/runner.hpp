// Runs a program in either time domain behind one interface.
#pragma once

#include "../dense/executor.hpp"
#include "../discrete/executor.hpp"
#include "../program/metadata.hpp"
#include "../program/program.hpp"
#include "../program/snapshot.hpp"
#include "../values/interval.hpp"
#include "rtamt.h"

#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace rtamt::c_api {

// An operation has no value: which instruction, and the sample or tick.
struct Undefined : std::exception {
    Undefined(std::uint32_t where, std::int64_t when) noexcept : instruction(where), step(when) {}
    [[nodiscard]] const char* what() const noexcept override { return "a value does not exist"; }

    std::uint32_t instruction;
    std::int64_t step;
};

class Runner {
  public:
    Runner() = default;
    virtual ~Runner() = default;
    Runner(const Runner&) = delete;
    Runner& operator=(const Runner&) = delete;
    Runner(Runner&&) = delete;
    Runner& operator=(Runner&&) = delete;

    [[nodiscard]] virtual const Program& program() const noexcept = 0;
    [[nodiscard]] virtual bool finished() const noexcept = 0;
    [[nodiscard]] virtual bool begun() const noexcept = 0; // whether a sample came
    [[nodiscard]] virtual std::optional<std::int64_t>
    known_until(std::size_t output) const noexcept = 0;

    // Throws Undefined; the state is then as it was.
    virtual void finish() = 0;
    virtual void reset() = 0;
    virtual void transfer(Snapshot& snapshot) = 0;

    // What the last call made known.
    [[nodiscard]] dense::Events last_output(std::size_t output) const noexcept {
        return outputs_[output].view();
    }

  protected:
    std::vector<dense::EventList> outputs_; // by output
};

// Samples come one period apart.
class SampledRunner : public Runner {
  public:
    // One value an input; the values of the first outputs.
    virtual void step(const double* row, std::span<rtamt_value> known) = 0;

    // The same sample `count` times, all of them or none.
    virtual void hold(std::span<const double> row, std::size_t count,
                      std::span<rtamt_value> known) = 0;
    [[nodiscard]] virtual std::int64_t samples() const noexcept = 0;

    // The values that each input may have; none where all may have any.
    [[nodiscard]] virtual std::span<const Bounds> ranges() const noexcept { return {}; }
};

class DiscreteRunner final : public SampledRunner {
  public:
    explicit DiscreteRunner(Program program);

    void step(const double* row, std::span<rtamt_value> known) override;
    void hold(std::span<const double> row, std::size_t count,
              std::span<rtamt_value> known) override;
    [[nodiscard]] std::int64_t samples() const noexcept override { return executor_.samples(); }

    [[nodiscard]] const Program& program() const noexcept override { return executor_.program(); }
    [[nodiscard]] bool finished() const noexcept override { return executor_.finished(); }
    [[nodiscard]] bool begun() const noexcept override { return executor_.samples() != 0; }
    [[nodiscard]] std::optional<std::int64_t>
    known_until(std::size_t output) const noexcept override;
    void finish() override;
    void reset() noexcept override;
    void transfer(Snapshot& snapshot) override { executor_.transfer(snapshot); }

  private:
    discrete::Executor executor_;

    void last_known(std::span<rtamt_value> known) const noexcept;
};

class DenseRunner final : public Runner {
  public:
    explicit DenseRunner(Program program);

    // Samples of one input at a time, at increasing ticks within the range; then all of them.
    void add(std::size_t input, std::int64_t tick, double value) {
        fresh_[input].append(tick, value);
    }
    void discard() noexcept;
    void push();

    // The first and the last tick of an input so far, added ones included.
    [[nodiscard]] std::optional<std::int64_t> first(std::size_t input) const noexcept;
    [[nodiscard]] std::optional<std::int64_t> last(std::size_t input) const noexcept;
    [[nodiscard]] std::int64_t last_possible() const noexcept { return executor_.last_possible(); }

    [[nodiscard]] const Program& program() const noexcept override { return executor_.program(); }
    [[nodiscard]] bool finished() const noexcept override { return executor_.finished(); }
    [[nodiscard]] bool begun() const noexcept override;
    [[nodiscard]] std::optional<std::int64_t>
    known_until(std::size_t output) const noexcept override {
        return executor_.known_until(output);
    }
    void finish() override;
    void reset() noexcept override;
    void transfer(Snapshot& snapshot) override { executor_.transfer(snapshot); }

  private:
    dense::Executor executor_;
    std::vector<dense::EventList> fresh_; // by input
    std::vector<dense::Events> events_;
};

[[nodiscard]] std::unique_ptr<Runner> make_runner(Program program, const Metadata& metadata);

} // namespace rtamt::c_api
