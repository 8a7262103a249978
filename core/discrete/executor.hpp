// Runs a program over samples in discrete time: online in chunks of any size, offline in one.
//
// Kernels run block by block, in the two groups of rollback_plan.hpp. An update of more than one
// block runs the guarded group over the whole chunk once to look for undefined values, takes it
// back, and then runs everything.
//
// An executor is a template over the value domain of the program's formulas. Numbers and formulas
// have registers of their own, since their values may differ; predicates take the one and give the
// other (wiring.hpp).
//
// Cost: a virtual call an instruction and block. Memory: state_bytes(), all of it allocated by the
// constructor but the registers, which grow once, in reserve(), from one slot to a block.
#pragma once

#include "../program/fault.hpp"
#include "../program/program.hpp"
#include "../values/domain.hpp"
#include "../values/real.hpp"
#include "kernel.hpp"
#include "wiring.hpp"
#include "zero_copy.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace rtamt::discrete {

// An operation computed NaN: the instruction, and the index of the sample of its value. Or a call
// failed: its message.
struct Failure {
    std::uint32_t instruction;
    std::int64_t sample;
    Fault fault;
};

// Samples of a longer trace, [begin, end), whose values depend on so many before and after these.
struct Part {
    std::size_t begin;
    std::size_t end;
    std::size_t before;
    std::size_t after;
};

enum class Outcome : std::uint8_t { failed, silent, known };

template <ValueDomain D>
class BasicExecutor {
  public:
    using Formula = typename D::Value;
    using Number = typename D::Number::Value;

    // Samples of an input one after another: numbers or formulas, whichever the program reads.
    using Column = std::conditional_t<UniformDomain<D>, const Formula*, const void*>;
    using Columns = std::span<const Column>;
    using Outputs = std::span<Formula* const>;

    explicit BasicExecutor(Program program);

    // Bytes of state of a new executor for this program, without making one.
    [[nodiscard]] static std::size_t memory(const Program& program)
        requires UniformDomain<D>;

    // Makes room for updates of `count` samples; afterwards these allocate nothing.
    void reserve(std::size_t count);

    // How many values of an output push(count samples) or finish() will make known.
    [[nodiscard]] std::size_t known(std::size_t output, std::size_t count) const noexcept;
    [[nodiscard]] std::size_t remaining(std::size_t output) const noexcept;

    // One sample of every input. `known` puts into `value` what became known of the first output.
    [[nodiscard]] Outcome step(const Formula* row, Formula& value) noexcept
        requires UniformDomain<D>;

    // `count` samples of every input; the values that become known of each output are written to
    // its buffer, which has room for known(output, count).
    [[nodiscard]] std::optional<Failure> push(Columns columns, std::size_t count, Outputs outputs);

    // No more samples: the rest of each output, remaining(output) values. Then only reset() helps.
    [[nodiscard]] std::optional<Failure> finish(Outputs outputs);

    void reset() noexcept;

    // Writes or reads what the samples so far have left behind, for an executor of the same
    // program. Discard an executor that could not read.
    void transfer(Snapshot& snapshot);

    // A whole trace at once, `count` values an output, independent of earlier input. Then only
    // another whole trace may follow; after a failure, nothing.
    [[nodiscard]] std::optional<Failure> evaluate(Columns columns, std::size_t count,
                                                  Outputs outputs);

    // A part of a whole trace of which these are the columns and outputs (parts.hpp).
    [[nodiscard]] std::optional<Failure> evaluate(Columns columns, std::size_t count,
                                                  Outputs outputs, const Part& part);

    // A whole trace with a separate executor.
    [[nodiscard]] static std::optional<Failure> evaluate(Program program, Columns columns,
                                                         std::size_t count, Outputs outputs);

    [[nodiscard]] const Program& program() const noexcept { return wiring_.program(); }
    [[nodiscard]] std::int64_t samples() const noexcept { return finished_ ? samples_ : slot_; }
    [[nodiscard]] bool finished() const noexcept { return finished_; }
    [[nodiscard]] std::size_t state_bytes() const noexcept;

    // Whether the samples of an input are numbers or formulas.
    [[nodiscard]] Sort input_sort(std::size_t input) const noexcept {
        return wiring_.input_sort(input);
    }

    // Why the last step() failed.
    [[nodiscard]] Failure failure() const noexcept { return failure_; }

    // What an instruction's register held at the last slot; nothing before the first one, or if the
    // register is used again (Wiring::keeps).
    [[nodiscard]] std::optional<Formula> last(std::uint32_t instruction) const noexcept
        requires UniformDomain<D>;

  private:
    Wiring<D> wiring_;
    std::optional<ZeroCopy> zero_copy_; // of whole traces, after which no register is read
    std::size_t last_ = 0;              // place of the last slot in the registers
    std::int64_t slot_ = 0;             // the next slot
    std::int64_t samples_ = endless;
    bool finished_ = false;
    Failure failure_{};

    [[nodiscard]] std::size_t longest_block() const noexcept {
        if (!zero_copy_) return wiring_.capacity();
        if (!zero_copy_->complete()) {
            const bool present = slot_ >= program().latest() && samples_ == endless;
            return present ? wiring_.trace_block() : wiring_.capacity();
        }
        // Without registers long ones cost less, as long as columns that are read again stay in the
        // second cache.
        return zero_copy_->single() ? std::numeric_limits<std::size_t>::max() : 4096;
    }
    void begin_trace(std::size_t count);
    [[nodiscard]] bool end_trace(std::size_t count, Outputs outputs);
    void checkpoint(std::size_t count) noexcept;
    void rollback() noexcept;
    void load(Columns columns, std::size_t offset, const Block& block) noexcept;
    void deliver(const Block& block, std::int64_t start, Outputs outputs) noexcept;
    [[nodiscard]] bool run_guarded(const Block& block) noexcept;
    void bind_buffers(Columns columns, std::size_t offset, const Block& block, std::int64_t start,
                      Outputs outputs) noexcept;
    void run_free(const Block& block) noexcept;
    [[nodiscard]] std::size_t idle(std::int64_t slot, std::size_t count) const noexcept;
    [[nodiscard]] bool advance(Columns columns, std::size_t count, Outputs outputs,
                               bool checked) noexcept;
    [[nodiscard]] bool update(Columns columns, std::size_t count, Outputs outputs) noexcept;
    [[nodiscard]] bool dry_run(Columns columns, std::size_t count) noexcept;
};

using Executor = BasicExecutor<Real>;

} // namespace rtamt::discrete
