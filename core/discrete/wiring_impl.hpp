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
    const std::size_t size = program.instructions.size();
    Plan plan{sorts(program), program.guarded()};
    for (std::size_t i = 0; i < size; ++i) {
        const std::size_t state = Kernels<D>::state_size(program.instructions[i], plan.sorts[i]);
        plan.state = detail::checked_sum(plan.state, state);
        if (plan.guarded[i]) plan.journal = detail::checked_sum(plan.journal, state);
        plan.registers += plan.sorts[i] == Sort::number ? sizeof(Number) : sizeof(Formula);
    }
    (void)detail::checked_sum(detail::checked_sum(plan.state, plan.journal), plan.registers);
    return plan;
}

template <ValueDomain D>
Wiring<D>::Wiring(Program program) : Wiring{plan(program), std::move(program)} {}

template <ValueDomain D>
Wiring<D>::Wiring(Plan plan, Program program)
    : program_(std::move(program)), sorts_(std::move(plan.sorts)),
      arena_(plan.state + plan.journal), crossed_(program_.instructions.size()),
      input_sorts_(program_.inputs, Sort::formula) {
    if (!std::same_as<D, Real> && !program_.calls.empty()) {
        throw std::invalid_argument("This program runs code of its own, which computes with real "
                                    "numbers only.");
    }
    add_registers(plan.guarded);
    add_kernels(plan.guarded);
    for (const std::uint32_t output : program_.outputs)
        cross(output, Sort::formula, plan.guarded[output]);
    if (!units_.can_fail()) {
        numbers_.protect_nothing();
        formulas_.protect_nothing();
    }
    connect();
}

template <ValueDomain D>
Wiring<D>::Place Wiring<D>::add_constant(Sort sort, double x) {
    return {sort, sort == Sort::number ? numbers_.add_constant(D::Number::of(x))
                                       : formulas_.add_constant(D::of(x))};
}

// A register for each instruction, in the bank of its sort.
template <ValueDomain D>
void Wiring<D>::add_registers(const std::vector<bool>& guarded) {
    for (std::uint32_t i = 0; i < program_.instructions.size(); ++i) {
        const Instruction& instruction = program_.instructions[i];
        const bool number = sorts_[i] == Sort::number;
        Place place{sorts_[i], 0};
        if (instruction.opcode == Opcode::constant) {
            place = add_constant(place.sort, instruction.x);
        } else if (instruction.opcode == Opcode::input) {
            const auto column = static_cast<std::size_t>(instruction.n);
            place.row = number ? numbers_.add_input(i, column) : formulas_.add_input(i, column);
            if (number) input_sorts_[column] = Sort::number;
        } else {
            place.row = number ? numbers_.add() : formulas_.add();
        }
        places_.push_back(place);
        if (instruction.opcode == Opcode::input ||
            (guarded[i] && instruction.opcode != Opcode::constant)) {
            number ? numbers_.protect(place.row) : formulas_.protect(place.row);
        }
    }
}

template <ValueDomain D>
void Wiring<D>::add_kernels(const std::vector<bool>& guarded) {
    kernels_.reserve(program_.instructions.size());
    for (std::uint32_t i = 0; i < program_.instructions.size(); ++i) {
        const Instruction& instruction = program_.instructions[i];
        const Sort sort = taken(instruction, sorts_[i]);
        program_.each_operand(
            instruction, [&](std::uint32_t operand) { cross(operand, sort, guarded[operand]); });
        const std::size_t size = Kernels<D>::state_size(instruction, sorts_[i]);
        void* state = arena_.take(size);
        void* journal = guarded[i] ? arena_.take(size) : nullptr;
        auto kernel =
            instruction.opcode == Opcode::call
                ? make_call(i)
                : Kernels<D>::make(
                      instruction, sorts_[i], program_.operand_lag(instruction), state, journal,
                      {program_.is_constant(instruction.a), program_.is_constant(instruction.b)});
        if (kernel) {
            units_.add({kernel.get(), i}, guarded[i], !info(instruction.opcode).pointwise);
            Wire wire{kernel.get(), {}, {}, places_[i]};
            if (instruction.a != no_operand) wire.a = place(instruction.a, sort);
            if (instruction.b != no_operand) wire.b = place(instruction.b, sort);
            wires_.push_back(wire);
        }
        kernels_.push_back(std::move(kernel));
        if (size != 0) longest_ = std::max(longest_, instruction.n);
    }
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
        if (instruction.opcode == Opcode::constant) {
            crossed_[index] = add_constant(sort, instruction.x);
            return;
        }
        const Place place{sort, sort == Sort::number ? numbers_.add() : formulas_.add()};
        auto kernel = Kernels<D>::cross(sorts_[index], instruction.lag);
        units_.add({kernel.get(), index}, guarded, false);
        wires_.push_back({kernel.get(), places_[index], {}, place});
        crossed_[index] = place;
        crossings_.push_back(std::move(kernel));
    }
}

template <ValueDomain D>
std::size_t Wiring<D>::memory(const Program& program)
    requires UniformDomain<D>
{
    const Plan sizes = plan(program);
    return sizes.state + sizes.journal + sizes.registers;
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
    numbers_.settle(capacity_);
    formulas_.settle(capacity_);
    for (const Wire& wire : wires_) {
        wire.kernel->connect(wire.a ? at(*wire.a) : nullptr, wire.b ? at(*wire.b) : nullptr,
                             at(wire.out));
    }
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
    capacity_ = block;
    connect();
}

} // namespace rtamt::discrete
