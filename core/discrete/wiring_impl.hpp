// The definitions of wiring.hpp, for the files that instantiate it for a domain (real.cpp and its
// neighbours).
#pragma once

#include "wiring.hpp"

#include "../program/sorts.hpp"
#include "kernels.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace rtamt::discrete {

namespace detail {

// A cache line more than a block: else the same place of every register would fall into the same
// few cache sets.
template <class Value>
[[nodiscard]] constexpr std::size_t stride(std::size_t block) noexcept {
    return block + std::max<std::size_t>(64 / sizeof(Value), 1);
}

[[nodiscard]] inline std::size_t checked_sum(std::size_t a, std::size_t b) {
    if (b > std::numeric_limits<std::size_t>::max() - a) {
        throw std::invalid_argument("This program needs more memory than can be addressed: make "
                                    "its time bounds smaller or its period longer.");
    }
    return a + b;
}

} // namespace detail

template <ValueDomain D>
Wiring<D>::Plan Wiring<D>::plan(const Program& program) {
    Plan plan{sorts(program),
              chain_width<D> == 0 ? unfused(program) : fused(program, chain_width<D> > 1),
              {}};
    std::size_t numbers = 0;
    for (std::size_t i = 0; i < program.instructions.size(); ++i) {
        const std::size_t state = Kernels<D>::state_size(program.instructions[i], plan.sorts[i]);
        plan.state = detail::checked_sum(plan.state, state);
        if (plan.fusion.guarded[i]) plan.journal = detail::checked_sum(plan.journal, state);
        numbers += static_cast<std::size_t>(plan.sorts[i] == Sort::number);
    }
    if constexpr (UniformDomain<D>) {
        plan.registers = registers(program, plan.fusion);
        plan.cells = plan.registers.count * sizeof(Formula);
    } else {
        plan.cells =
            numbers * sizeof(Number) + (program.instructions.size() - numbers) * sizeof(Formula);
    }
    (void)detail::checked_sum(detail::checked_sum(plan.state, plan.journal), plan.cells);
    return plan;
}

template <ValueDomain D>
Wiring<D>::Wiring(Program program) : Wiring{plan(program), std::move(program)} {}

template <ValueDomain D>
Wiring<D>::Wiring(Plan plan, Program program)
    : program_(std::move(program)), sorts_(std::move(plan.sorts)), fusion_(std::move(plan.fusion)),
      arena_(plan.state + plan.journal), crossed_(program_.instructions.size()),
      kept_(program_.instructions.size()), input_sorts_(program_.inputs, Sort::formula) {
    if (!std::same_as<D, Real> && !program_.calls.empty()) {
        throw std::invalid_argument("This program runs code of its own, which computes with real "
                                    "numbers only.");
    }
    add_registers(plan.registers);
    add_kernels();
    for (const std::uint32_t output : program_.outputs)
        cross(output, Sort::formula, fusion_.guarded[output]);
    keep_registers();
    connect();
}

// A register for each instruction that needs one, in the bank of its sort.
template <ValueDomain D>
void Wiring<D>::add_registers(const Registers& registers) {
    for (std::uint32_t row = 0; row < registers.count; ++row)
        (void)formulas_.add();
    for (std::uint32_t i = 0; i < program_.instructions.size(); ++i) {
        const Instruction& instruction = program_.instructions[i];
        const auto column = static_cast<std::size_t>(instruction.n);
        Place place{sorts_[i]};
        if constexpr (UniformDomain<D>) {
            place = {Sort::formula, registers.rows[i]};
        } else {
            place.row = place.sort == Sort::number ? numbers_.add() : formulas_.add();
        }
        places_.push_back(place);
        if (instruction.opcode == Opcode::input) {
            place.sort == Sort::number ? numbers_.take_input(place.row, i, column)
                                       : formulas_.take_input(place.row, i, column);
            if (sorts_[i] == Sort::number) input_sorts_[column] = Sort::number;
        } else if (instruction.opcode == Opcode::constant) {
            fill_register(place, instruction.x);
        }
    }
}

template <ValueDomain D>
void Wiring<D>::fill_register(const Place& place, double x) {
    if (place.row == no_register) return;
    place.sort == Sort::number ? numbers_.fill(place.row, D::Number::of(x))
                               : formulas_.fill(place.row, D::of(x));
}

// Outputs can be asked for after an update, and all others where no registers are reused; a failed
// update leaves them as they were.
template <ValueDomain D>
void Wiring<D>::keep_registers() {
    const bool all = !UniformDomain<D> || !program_.applies(Pass::reuse);
    for (std::uint32_t i = 0; i < places_.size(); ++i)
        kept_[i] = all && places_[i].row != no_register;
    for (const std::uint32_t output : program_.outputs)
        kept_[output] = true;
    if (!units_.can_fail()) return;
    for (std::uint32_t i = 0; i < places_.size(); ++i) {
        const Opcode opcode = program_.instructions[i].opcode;
        if (!kept_[i] || opcode == Opcode::constant) continue;
        if (opcode != Opcode::input && !fusion_.guarded[i]) continue;
        places_[i].sort == Sort::number ? numbers_.protect(places_[i].row)
                                        : formulas_.protect(places_[i].row);
    }
}

template <ValueDomain D>
void Wiring<D>::add_kernels() {
    kernels_.reserve(program_.instructions.size());
    std::vector<std::vector<std::uint32_t>> chains(program_.instructions.size()); // by root
    for (std::uint32_t i = 0; i < chains.size(); ++i) {
        if (fusion_.chained[i]) chains[fusion_.roots[i]].push_back(i);
    }
    for (std::uint32_t i = 0; i < program_.instructions.size(); ++i) {
        const Instruction& instruction = program_.instructions[i];
        const Sort sort = taken(instruction, sorts_[i]);
        program_.each_operand(instruction, [&](std::uint32_t operand) {
            cross(operand, sort, fusion_.guarded[operand]);
        });
        auto kernel = fusion_.inside(i) ? nullptr : make_kernel(i, chains[i]);
        if (kernel) {
            units_.add({kernel.get(), i}, fusion_.guarded[i], !info(instruction.opcode).pointwise);
            wire(*kernel, i);
        }
        kernels_.push_back(std::move(kernel));
    }
}

template <ValueDomain D>
std::unique_ptr<Kernel> Wiring<D>::make_kernel(std::uint32_t index,
                                               std::span<const std::uint32_t> chain) {
    const Instruction& instruction = program_.instructions[index];
    if (instruction.opcode == Opcode::call) return make_call(index);
    if (!chain.empty()) return make_chain(chain);
    const std::size_t size = Kernels<D>::state_size(instruction, sorts_[index]);
    if (const Count count = info(instruction.opcode).count;
        count == Count::distance || count == Count::width || count == Count::rank) {
        longest_ = std::max(longest_, instruction.n);
    }
    void* state = arena_.take(size);
    void* journal = fusion_.guarded[index] ? arena_.take(size) : nullptr;
    return Kernels<D>::make(
        instruction, sorts_[index], program_.operand_lag(instruction), state, journal,
        {program_.is_constant(instruction.a), program_.is_constant(instruction.b)});
}

template <ValueDomain D>
std::unique_ptr<Kernel> Wiring<D>::make_call(std::uint32_t index) {
    const Instruction& instruction = program_.instructions[index];
    const CallSite& site = program_.calls[static_cast<std::size_t>(instruction.n)];
    auto kernel = std::make_unique<Call>(*site.kernel, site.setup,
                                         program_.operand_lag(instruction), instruction.lag);
    calls_.emplace_back(kernel.get(), index);
    return kernel;
}

template <ValueDomain D>
std::unique_ptr<Kernel> Wiring<D>::make_chain(std::span<const std::uint32_t> members) {
    auto kernel =
        std::make_unique<Chain>(chain_code(program_, fusion_, members),
                                program_.instructions[members.back()].lag, chain_width<D>);
    chains_.push_back(kernel.get());
    return kernel;
}

// What a kernel reads and writes.
template <ValueDomain D>
void Wiring<D>::wire(Kernel& kernel, std::uint32_t index) {
    const Instruction& instruction = program_.instructions[index];
    const Sort sort = taken(instruction, sorts_[index]);
    if (fusion_.chained[index]) {
        Chain& chain = *chains_.back();
        for (std::size_t i = 0; i < chain.columns().size(); ++i)
            add_read(chain.column(i), chain.columns()[i], sort);
    } else {
        if (instruction.a != no_operand) add_read(kernel.a_cell(), instruction.a, sort);
        if (instruction.b != no_operand) add_read(kernel.b_cell(), instruction.b, sort);
    }
    writes_.push_back({kernel.out_cell(), index});
    written_.push_back(places_[index]);
}

template <ValueDomain D>
void Wiring<D>::add_read(const void** cell, std::uint32_t operand, Sort sort) {
    const Place read = place(operand, sort);
    const bool once = read.row == no_register;
    if (once) constants_.push_back(D::of(program_.instructions[operand].x));
    reads_.push_back({cell, operand, once});
    read_.push_back(read);
}

// Where the value of an instruction is read as a value of this sort.
template <ValueDomain D>
Wiring<D>::Place Wiring<D>::place(std::uint32_t instruction, Sort sort) const noexcept {
    if constexpr (!UniformDomain<D>) {
        if (sorts_[instruction] != sort) {
            return *crossed_[instruction];
        }
    }
    return places_[instruction];
}

// Has the value of an instruction in a register of this sort, too.
template <ValueDomain D>
void Wiring<D>::cross(std::uint32_t index, Sort sort, bool guarded) {
    if constexpr (!UniformDomain<D>) {
        if (sorts_[index] == sort || crossed_[index]) return;
        const Instruction& instruction = program_.instructions[index];
        const Place place{sort, sort == Sort::number ? numbers_.add() : formulas_.add()};
        crossed_[index] = place;
        if (instruction.opcode == Opcode::constant) {
            fill_register(place, instruction.x);
            return;
        }
        auto kernel = Kernels<D>::cross(sorts_[index], instruction.lag);
        units_.add({kernel.get(), index}, guarded, false);
        reads_.push_back({kernel->a_cell(), index, false});
        read_.push_back(places_[index]);
        writes_.push_back({kernel->out_cell(), index});
        written_.push_back(place);
        crossings_.push_back(std::move(kernel));
    }
}

template <ValueDomain D>
std::size_t Wiring<D>::memory(const Program& program)
    requires UniformDomain<D>
{
    const Plan sizes = plan(program);
    return sizes.state + sizes.journal + sizes.cells;
}

template <ValueDomain D>
std::size_t Wiring<D>::bytes() const noexcept {
    return arena_.bytes() + numbers_.bytes() + formulas_.bytes();
}

template <ValueDomain D>
void* Wiring<D>::at(const Place& place) noexcept {
    if (place.sort == Sort::number) return numbers_.at(place.row);
    return formulas_.at(place.row);
}

template <ValueDomain D>
void Wiring<D>::connect() {
    numbers_.settle(trace_block_);
    formulas_.settle(trace_block_);
    for (Chain* chain : chains_)
        chain->make_room(capacity_);
    auto constant = constants_.cbegin();
    for (std::size_t i = 0; i < reads_.size(); ++i)
        *reads_[i].cell = reads_[i].once ? static_cast<const void*>(&*constant++) : at(read_[i]);
    for (std::size_t i = 0; i < writes_.size(); ++i)
        *writes_[i].cell = at(written_[i]);
    for (const auto& [call, index] : calls_) {
        std::vector<const double*> registers;
        program_.each_operand(program_.instructions[index], [&](std::uint32_t operand) {
            registers.push_back(static_cast<const double*>(at(places_[operand])));
        });
        call->connect_operands(std::move(registers));
    }
    outputs_.clear();
    for (const std::uint32_t output : program_.outputs)
        outputs_.push_back(static_cast<Formula*>(at(place(output, Sort::formula))));
}

template <ValueDomain D>
void Wiring<D>::grow(std::size_t last) {
    numbers_.grow(detail::stride<Number>(block), last);
    formulas_.grow(detail::stride<Formula>(block), last);
    capacity_ = trace_block_ = block;
    connect();
}

// Blocks are as long as keeps the registers in a part of the second cache: kernels are called less
// often, and more of each column is read and written at once, which is worth more than the first
// cache. Code that is called keeps its blocks.
template <ValueDomain D>
void Wiring<D>::grow_for_trace(std::size_t slots, std::span<const std::size_t> bypassed)
    requires UniformDomain<D>
{
    constexpr std::size_t cache = std::size_t{64} * 1024;
    const std::size_t used = std::max<std::size_t>(formulas_.rows() - bypassed.size(), 1);
    const std::size_t longest = program_.calls.empty() ? longest_trace_block * block : block;
    const std::size_t fitting = std::clamp(cache / (used * sizeof(Formula)), block, longest);
    const std::size_t wanted = std::min(fitting, std::max(slots, block));
    if (slots <= capacity_ || wanted <= trace_block_) return;
    std::vector<std::uint32_t> rows; // outputs share no register
    rows.reserve(bypassed.size());
    for (const std::size_t output : bypassed)
        rows.push_back(places_[program_.outputs[output]].row);
    formulas_.arrange(detail::stride<Formula>(wanted), rows, detail::stride<Formula>(block));
    capacity_ = block;
    trace_block_ = wanted;
    connect();
}

} // namespace rtamt::discrete
