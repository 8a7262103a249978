// A program made ready to run: registers and kernels, and which reads and writes what.
//
// Each instruction has a register in the bank of its sort, numbers or formulas. Where it is read as
// a value of the other sort, and the values of both sorts differ, it has a second register there,
// and a kernel that copies one to the other right after the instruction; a constant needs no
// kernel.
//
// Cost: none once it is connected. Memory: bytes(), all of it allocated by the constructor but the
// registers, which grow() makes larger.
#pragma once

#include "../program/program.hpp"
#include "../program/rollback_plan.hpp"
#include "../values/domain.hpp"
#include "arena.hpp"
#include "bank.hpp"
#include "call.hpp"
#include "kernel.hpp"

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

    explicit Wiring(Program program);

    // Bytes of a new one for this program, without making it.
    [[nodiscard]] static std::size_t memory(const Program& program)
        requires UniformDomain<D>;

    // Makes room for a block, keeping slot `last` of each register as the first.
    void grow(std::size_t last);

    [[nodiscard]] const Program& program() const noexcept { return program_; }
    [[nodiscard]] Bank<Number>& numbers() noexcept { return numbers_; }
    [[nodiscard]] Bank<Formula>& formulas() noexcept { return formulas_; }
    [[nodiscard]] const RollbackPlan<Unit>& units() const noexcept { return units_; }
    [[nodiscard]] std::size_t capacity() const noexcept { return capacity_; }
    [[nodiscard]] std::size_t bytes() const noexcept;

    // Slots after which no window or delay remembers anything.
    [[nodiscard]] std::int64_t memory_length() const noexcept { return longest_; }

    // By instruction; none for inputs and constants.
    [[nodiscard]] std::span<const std::unique_ptr<Kernel>> kernels() const noexcept {
        return kernels_;
    }

    // The register of an output, which is read as a formula.
    [[nodiscard]] Formula* output(std::size_t output) const noexcept { return outputs_[output]; }

    // Whether the samples of an input are numbers or formulas.
    [[nodiscard]] Sort input_sort(std::size_t input) const noexcept { return input_sorts_[input]; }

    // Calls visit(value) with what each register holds at a slot, in the order of instructions.
    template <class Visit>
    void each_value(std::size_t slot, Visit&& visit) {
        for (const Place& place : places_) {
            if (place.sort == Sort::number) {
                visit(numbers_.at(place.row)[slot]);
            } else {
                visit(formulas_.at(place.row)[slot]);
            }
        }
    }
    [[nodiscard]] Formula value(std::uint32_t instruction, std::size_t slot) const noexcept
        requires UniformDomain<D>
    {
        const Place& place = places_[instruction];
        return (place.sort == Sort::number ? numbers_ : formulas_).at(place.row)[slot];
    }

  private:
    // Where a value is: in which bank, and in which row of it.
    struct Place {
        Sort sort;
        std::uint32_t row;
    };
    struct Wire {
        Kernel* kernel;
        std::optional<Place> a;
        std::optional<Place> b;
        Place out;
    };
    // Sizes in bytes; the guarded part of the state has a journal of the same size.
    struct Plan {
        std::vector<Sort> sorts;
        std::vector<bool> guarded;
        std::size_t state = 0;
        std::size_t journal = 0;
        std::size_t registers = 0; // with one slot each
    };

    Program program_;
    std::vector<Sort> sorts_; // by instruction
    Arena arena_;
    Bank<Number> numbers_;
    Bank<Formula> formulas_;
    std::vector<Place> places_;                 // by instruction
    std::vector<std::optional<Place>> crossed_; // by instruction, in the other bank
    std::vector<std::unique_ptr<Kernel>> kernels_;
    std::vector<std::unique_ptr<Kernel>> crossings_;
    std::vector<std::pair<Call*, std::uint32_t>> calls_; // and their instructions
    std::vector<Wire> wires_;
    RollbackPlan<Unit> units_;
    std::vector<Sort> input_sorts_;
    std::vector<Formula*> outputs_;
    std::size_t capacity_ = 1; // slots in a register
    std::int64_t longest_ = 0;

    Wiring(Plan plan, Program program);

    [[nodiscard]] static Plan plan(const Program& program);
    void add_registers(const std::vector<bool>& guarded);
    void add_kernels(const std::vector<bool>& guarded);
    [[nodiscard]] std::unique_ptr<Kernel> make_call(std::uint32_t index);
    [[nodiscard]] Place add_constant(Sort sort, double x);
    void cross(std::uint32_t index, Sort sort, bool guarded);
    [[nodiscard]] Place place(std::uint32_t index, Sort sort) const noexcept;
    [[nodiscard]] void* at(const Place& place) noexcept;
    void connect();
};

} // namespace rtamt::discrete
