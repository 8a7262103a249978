// Runs a program over samples in discrete time: online in chunks of any size, offline in one.
//
// Kernels run block by block, in two groups. The *guarded* group is every instruction that can
// make NaN and everything such an instruction is computed from; the rest cannot fail. An update
// runs the guarded group first and looks for NaN; when there is one, it takes the guarded kernels
// back to where they were, and the rest has not moved. So a failed update leaves no trace. An
// update of more than one block runs the guarded group over the whole chunk once to look, takes it
// back, and then runs everything.
//
// Cost: a virtual call an instruction and block. Memory: state_bytes(), all of it allocated by the
// constructor but the registers, which grow once, in reserve(), from one slot to a block.
#pragma once

#include "../arena.hpp"
#include "../fault.hpp"
#include "../kernel.hpp"
#include "../program.hpp"
#include "call.hpp"
#include "direct.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace rtamt::discrete {

// An operation made NaN: which instruction, and the index of the sample its value is for. Or a call
// failed: what it said.
struct Failure {
    std::uint32_t instruction;
    std::int64_t sample;
    Fault fault;
};

enum class Outcome : std::uint8_t { failed, silent, known };

class Executor {
  public:
    explicit Executor(Program program);

    // Bytes of state of a new executor for this program, without making one.
    [[nodiscard]] static std::size_t memory(const Program& program);

    // Makes room for updates of `count` samples; afterwards these allocate nothing.
    void reserve(std::size_t count);

    // How many values of an output push(count samples) or finish() will make known.
    [[nodiscard]] std::size_t known(std::size_t output, std::size_t count) const noexcept;
    [[nodiscard]] std::size_t remaining(std::size_t output) const noexcept;

    // One sample of every input. `known` puts into `value` what became known of the first output.
    [[nodiscard]] Outcome step(const double* row, double& value) noexcept;

    // `count` samples of every input; the values that become known of each output are written to
    // its buffer, which has room for known(output, count).
    [[nodiscard]] std::optional<Failure> push(std::span<const double* const> columns,
                                              std::size_t count, std::span<double* const> outputs);

    // No more samples: the rest of each output, remaining(output) values. Then only reset() helps.
    [[nodiscard]] std::optional<Failure> finish(std::span<double* const> outputs);

    void reset() noexcept;

    // Writes or reads what the samples so far have left behind, for an executor of the same
    // program. One that could not read is to be thrown away.
    void transfer(Snapshot& snapshot);

    // A whole trace at once, `count` values an output; what a failure leaves behind is unspecified.
    [[nodiscard]] static std::optional<Failure> evaluate(Program program,
                                                         std::span<const double* const> columns,
                                                         std::size_t count,
                                                         std::span<double* const> outputs);

    [[nodiscard]] const Program& program() const noexcept { return program_; }
    [[nodiscard]] std::int64_t samples() const noexcept { return finished_ ? samples_ : slot_; }
    [[nodiscard]] bool finished() const noexcept { return finished_; }
    [[nodiscard]] std::size_t state_bytes() const noexcept;

    // Why the last step() failed.
    [[nodiscard]] Failure failure() const noexcept { return failure_; }

    // What an instruction's register held at the last slot; NaN before the first one.
    [[nodiscard]] double last(std::uint32_t instruction) const noexcept;

  private:
    struct Unit {
        Kernel* kernel;
        std::uint32_t instruction;
    };
    struct Input {
        std::uint32_t instruction;
        std::uint32_t column;
        double* values; // its register
    };
    // A register that a failed update overwrites, and what its last slot held before.
    struct Fragile {
        std::uint32_t instruction;
        double* values;
        double last;
    };
    // Sizes in doubles; the guarded part of the state has a journal of the same size.
    struct Plan {
        std::vector<bool> guarded;
        std::size_t state = 0;
        std::size_t journal = 0;
    };

    Program program_;
    Arena arena_;
    std::vector<std::unique_ptr<Kernel>> kernels_; // by instruction; none for inputs and constants
    std::vector<Unit> guarded_;
    std::vector<Unit> free_;
    std::vector<std::pair<Call*, std::uint32_t>> calls_; // and their instructions
    std::vector<Kernel*> reversible_;                    // the guarded kernels with state
    std::vector<Input> inputs_;
    std::vector<Fragile> fragile_;
    Direct direct_; // of use to evaluate() alone, after which nobody looks at registers
    std::vector<double> registers_;
    std::size_t capacity_ = 1; // slots in a register
    std::size_t stride_ = 1;   // doubles from one register to the next
    std::size_t last_ = 0;     // place of the last slot in the registers
    std::int64_t slot_ = 0;    // the next slot
    std::int64_t longest_ = 0; // slots after which no window or delay remembers anything
    std::int64_t samples_ = endless;
    bool finished_ = false;
    Failure failure_{};

    Executor(const Plan& plan, Program program);

    [[nodiscard]] static Plan plan(const Program& program);
    [[nodiscard]] std::unique_ptr<Kernel> make_call(std::uint32_t index);
    [[nodiscard]] double* register_of(std::uint32_t instruction) noexcept;
    [[nodiscard]] const double* register_of(std::uint32_t instruction) const noexcept;
    void connect();

    void checkpoint(std::size_t count) noexcept;
    void rollback() noexcept;
    void load(std::span<const double* const> columns, std::size_t offset,
              const Block& block) noexcept;
    void deliver(const Block& block, std::int64_t start, std::span<double* const> outputs) noexcept;
    [[nodiscard]] bool run_guarded(const Block& block) noexcept;
    void aim(std::span<const double* const> columns, std::size_t offset, const Block& block,
             std::int64_t start, std::span<double* const> outputs) noexcept;
    void run_free(const Block& block) noexcept;
    [[nodiscard]] std::size_t idle(std::int64_t slot, std::size_t count) const noexcept;
    [[nodiscard]] bool advance(std::span<const double* const> columns, std::size_t count,
                               std::span<double* const> outputs, bool checked) noexcept;
    [[nodiscard]] bool update(std::span<const double* const> columns, std::size_t count,
                              std::span<double* const> outputs) noexcept;
    [[nodiscard]] bool survey(std::span<const double* const> columns, std::size_t count) noexcept;
};

} // namespace rtamt::discrete
