// A program made ready to run: registers and kernels, and which reads and writes what.
//
// Where numbers and formulas have the same values, chains of instructions are one kernel
// (fusion.hpp), values share registers (liveness.hpp), and constants that are read once a block
// have none. Where they differ, each instruction has a register in the bank of its sort. One that
// is read as a value of the other sort has a second register there, and a kernel that copies one to
// the other right after the instruction; a constant needs no kernel.
//
// Cost: none once it is connected. Memory: bytes(), all of it allocated by the constructor but the
// registers, which grow() makes larger.
#pragma once

#include "../program/fusion.hpp"
#include "../program/liveness.hpp"
#include "../program/program.hpp"
#include "../program/rollback_plan.hpp"
#include "../values/domain.hpp"
#include "arena.hpp"
#include "bank.hpp"
#include "call.hpp"
#include "chain.hpp"
#include "kernel.hpp"
#include "zero_copy.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace rtamt::discrete {

struct Unit {
    Kernel* kernel;
    std::uint32_t instruction;
};

template <ValueDomain D>
class Wiring {
  public:
    using Formula = typename D::Value;
    using Number = typename D::Number::Value;

    // The most slots that registers have room for: a few registers stay in the first cache.
    static constexpr std::size_t block =
        std::max<std::size_t>(2048 / std::max(sizeof(Number), sizeof(Formula)), 16);

    // How many times as many slots blocks of whole traces may have.
    static constexpr std::size_t longest_trace_block = 8;

    explicit Wiring(Program program);

    // Bytes of a new one for this program, without making it.
    [[nodiscard]] static std::size_t memory(const Program& program)
        requires UniformDomain<D>;

    // For blocks of any length, of which nothing is in registers.
    void run_long_blocks() {
        for (Chain* chain : chains_)
            chain->make_room(block);
    }

    // Makes room for a block, keeping slot `last` of each register as the first.
    void grow(std::size_t last);

    // Before a whole trace of so many slots: makes room for blocks of trace_block() slots in all
    // registers but those of outputs that are bypassed, and for a block in these.
    void grow_for_trace(std::size_t slots, std::span<const std::size_t> bypassed)
        requires UniformDomain<D>;
    [[nodiscard]] std::size_t trace_block() const noexcept { return trace_block_; }

    [[nodiscard]] const Program& program() const noexcept { return program_; }
    [[nodiscard]] Bank<Number>& numbers() noexcept { return numbers_; }
    [[nodiscard]] Bank<Formula>& formulas() noexcept { return formulas_; }
    [[nodiscard]] const RollbackPlan<Unit>& units() const noexcept { return units_; }
    [[nodiscard]] std::size_t capacity() const noexcept { return capacity_; }
    [[nodiscard]] std::size_t bytes() const noexcept;

    // Slots after which no window or delay remembers anything.
    [[nodiscard]] std::int64_t memory_length() const noexcept { return longest_; }

    // By instruction; none for inputs and constants, and inside of chains.
    [[nodiscard]] std::span<const std::unique_ptr<Kernel>> kernels() const noexcept {
        return kernels_;
    }

    // What kernels read and write, but for calls.
    [[nodiscard]] std::span<const Read> reads() const noexcept { return reads_; }
    [[nodiscard]] std::span<const Write> writes() const noexcept { return writes_; }

    // The register of an output, which is read as a formula.
    [[nodiscard]] Formula* output(std::size_t output) const noexcept { return outputs_[output]; }

    // Whether the samples of an input are numbers or formulas.
    [[nodiscard]] Sort input_sort(std::size_t input) const noexcept { return input_sorts_[input]; }

    // Whether the last value of an instruction stays in its register: those of outputs do, and all
    // where no registers are reused.
    [[nodiscard]] bool keeps(std::uint32_t instruction) const noexcept {
        return kept_[instruction];
    }

    // Calls visit(value) with what each register that is kept holds at a slot.
    template <class Visit>
    void each_value(std::size_t slot, Visit&& visit) {
        for (std::uint32_t i = 0; i < places_.size(); ++i) {
            if (!kept_[i]) continue;
            if (places_[i].sort == Sort::number) {
                visit(numbers_.at(places_[i].row)[slot]);
            } else {
                visit(formulas_.at(places_[i].row)[slot]);
            }
        }
    }

    // The value of an instruction that is kept.
    [[nodiscard]] Formula value(std::uint32_t instruction, std::size_t slot) const noexcept
        requires UniformDomain<D>
    {
        return formulas_.at(places_[instruction].row)[slot];
    }

  private:
    // Where a value is: in which bank, and in which row of it. A constant that is read once a block
    // is in no bank.
    struct Place {
        Sort sort{};
        std::uint32_t row = no_register;
    };
    // Sizes in bytes; the guarded part of the state has a journal of the same size.
    struct Plan {
        std::vector<Sort> sorts;
        Fusion fusion;
        Registers registers;
        std::size_t state = 0;
        std::size_t journal = 0;
        std::size_t cells = 0; // registers with one slot each
    };

    Program program_;
    std::vector<Sort> sorts_; // by instruction
    Fusion fusion_;
    Arena arena_;
    Bank<Number> numbers_;
    Bank<Formula> formulas_;
    std::vector<Place> places_;                 // by instruction
    std::vector<std::optional<Place>> crossed_; // by instruction, in the other bank
    std::vector<bool> kept_;                    // by instruction
    std::vector<Formula> constants_;            // that are read once a block, in order
    std::vector<std::unique_ptr<Kernel>> kernels_;
    std::vector<std::unique_ptr<Kernel>> crossings_;
    std::vector<Chain*> chains_;
    std::vector<std::pair<Call*, std::uint32_t>> calls_; // and their instructions
    std::vector<Read> reads_;
    std::vector<Write> writes_;
    std::vector<Place> read_;    // where they are
    std::vector<Place> written_; // likewise
    RollbackPlan<Unit> units_;
    std::vector<Sort> input_sorts_;
    std::vector<Formula*> outputs_;
    std::size_t capacity_ = 1;    // slots in a register
    std::size_t trace_block_ = 1; // slots in those that are not bypassed
    std::int64_t longest_ = 0;

    Wiring(Plan plan, Program program);

    [[nodiscard]] static Plan plan(const Program& program);
    void add_registers(const Registers& registers);
    void fill_register(const Place& place, double x);
    void keep_registers();
    void add_kernels();
    [[nodiscard]] std::unique_ptr<Kernel> make_kernel(std::uint32_t index,
                                                      std::span<const std::uint32_t> chain);
    [[nodiscard]] std::unique_ptr<Kernel> make_call(std::uint32_t index);
    [[nodiscard]] std::unique_ptr<Kernel> make_chain(std::span<const std::uint32_t> members);
    void wire(Kernel& kernel, std::uint32_t index);
    void add_read(const void** cell, std::uint32_t operand, Sort sort);
    void cross(std::uint32_t index, Sort sort, bool guarded);
    [[nodiscard]] Place place(std::uint32_t index, Sort sort) const noexcept;
    [[nodiscard]] void* at(const Place& place) noexcept;
    void connect();
};

} // namespace rtamt::discrete
