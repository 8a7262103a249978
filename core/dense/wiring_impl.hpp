// The definitions of wiring.hpp, for the files that instantiate it for a domain (real.cpp and its
// neighbours).
#pragma once

#include "wiring.hpp"

#include "../program/sorts.hpp"
#include "call.hpp"
#include "kernels.hpp"

#include <algorithm>
#include <concepts>
#include <stdexcept>

namespace rtamt::dense {

template <ValueDomain D>
Wiring<D>::Wiring(Program program)
    : program_(std::move(program)), sorts_(sorts(program_)), queues_(program_.inputs) {
    if (!std::same_as<D, Real> && !program_.calls.empty()) {
        throw std::invalid_argument("This program runs code of its own, which computes with real "
                                    "numbers only.");
    }
    for (std::size_t i = 0; i < sorts_.size(); ++i) {
        if (program_.instructions[i].opcode == Opcode::input) sorts_[i] = Sort::number;
    }
    const std::vector<bool> guards = program_.guarded();
    const std::vector<std::int64_t> reach = reaches();
    kernels_.resize(program_.instructions.size());
    add_constants(guards);
    for (std::uint32_t i = 0; i < kernels_.size(); ++i) {
        const Instruction& instruction = program_.instructions[i];
        const std::int64_t lag = program_.operand_lag(instruction);
        const Sort sort = taken(instruction, sorts_[i]);
        program_.each_operand(instruction,
                              [&](std::uint32_t source) { cross(source, sort, guards[source]); });
        kernels_[i] = instruction.opcode == Opcode::call ? make_call(instruction, lag)
                                                         : Kernels<D>::make(instruction, sorts_[i]);
        if (!kernels_[i]) continue;
        kernels_[i]->connect(operand(instruction.a, sort, lag), operand(instruction.b, sort, lag));
        units_.add({kernels_[i].get(), i, reach[i], false}, guards[i]);
    }
    for (const std::uint32_t output : program_.outputs) {
        cross(output, Sort::formula, guards[output]);
        outputs_.push_back(
            static_cast<const BasicEvents<Formula>*>(operand(output, Sort::formula, 0)));
    }
}

template <ValueDomain D>
std::unique_ptr<Kernel> Wiring<D>::make_call(const Instruction& instruction,
                                             std::int64_t lag) const {
    const CallSite& site = program_.calls[static_cast<std::size_t>(instruction.n)];
    auto kernel = std::make_unique<Call>(*site.kernel, site.setup, lag, instruction.lag);
    std::vector<const Events*> operands;
    program_.each_operand(instruction, [&](std::uint32_t index) {
        operands.push_back(static_cast<const Events*>(operand(index, Sort::number, lag)));
    });
    kernel->connect_operands(std::move(operands));
    return kernel;
}

// How long after the end of the trace, in arrival time, the values of each instruction still reach
// an output within the trace, or belong to the trace themselves. Later values need not exist.
template <ValueDomain D>
std::vector<std::int64_t> Wiring<D>::reaches() const {
    std::vector<std::int64_t> reaches;
    reaches.reserve(program_.instructions.size());
    for (const Instruction& instruction : program_.instructions)
        reaches.push_back(instruction.lag);
    for (std::size_t i = reaches.size(); i-- > 0;) {
        const Instruction& instruction = program_.instructions[i];
        const std::int64_t past = instruction.opcode == Opcode::shift ? instruction.n : 0;
        program_.each_operand(instruction, [&](std::uint32_t source) {
            reaches[source] = std::max(reaches[source], reaches[i] - past);
        });
    }
    return reaches;
}

// A kernel for each constant and each lag and sort with which it is read, in the guarded group
// where one of its readers is.
template <ValueDomain D>
void Wiring<D>::add_constants(const std::vector<bool>& guarded) {
    const auto add = [&](std::uint32_t index, Sort sort, std::int64_t lag, bool guard) {
        const Instruction& source = program_.instructions[index];
        if (source.opcode != Opcode::constant) return;
        auto& [kernel, is_guarded] = stands_[stand(index, sort, lag)];
        const bool fresh = !kernel;
        if (fresh) kernel = Kernels<D>::constant(sort, lag, source.x);
        const Unit unit{kernel.get(), index, 0, true};
        latest_constant_ = std::max(latest_constant_, lag);
        if (fresh) {
            units_.add(unit, guard);
        } else if (guard && !is_guarded) {
            units_.guard(unit);
        }
        is_guarded |= guard;
    };
    for (std::size_t i = 0; i < program_.instructions.size(); ++i) {
        const Instruction& instruction = program_.instructions[i];
        const std::int64_t lag = program_.operand_lag(instruction);
        const Sort sort = taken(instruction, sorts_[i]);
        program_.each_operand(instruction,
                              [&](std::uint32_t source) { add(source, sort, lag, guarded[i]); });
    }
    for (const std::uint32_t output : program_.outputs)
        add(output, Sort::formula, 0, false);
}

// Has the values of an instruction as values of this sort, too.
template <ValueDomain D>
void Wiring<D>::cross(std::uint32_t index, Sort sort, bool guarded) {
    if constexpr (!UniformDomain<D>) {
        const Instruction& instruction = program_.instructions[index];
        if (sorts_[index] == sort || instruction.opcode == Opcode::constant) return;
        auto& [kernel, is_guarded] = stands_[stand(index, sort, instruction.lag)];
        if (kernel) return;
        is_guarded = guarded;
        kernel = Kernels<D>::cross(sorts_[index], instruction.lag);
        kernel->connect(own(index), nullptr);
        units_.add({kernel.get(), index, 0, false}, guarded);
    }
}

// Values serve as either sort where both are of one domain.
template <ValueDomain D>
Wiring<D>::Stand Wiring<D>::stand(std::uint32_t index, Sort sort, std::int64_t lag) const noexcept {
    return {index, UniformDomain<D> ? Sort::formula : sort, lag};
}

// The events of an instruction, of its own sort.
template <ValueDomain D>
const void* Wiring<D>::own(std::uint32_t index) const {
    const Instruction& instruction = program_.instructions[index];
    if (instruction.opcode == Opcode::input) {
        return &queues_[static_cast<std::size_t>(instruction.n)].view();
    }
    return kernels_[index]->result();
}

// The events of an instruction as values of a sort; those of a constant begin with the operands of
// this lag.
template <ValueDomain D>
const void* Wiring<D>::operand(std::uint32_t index, Sort sort, std::int64_t lag) const {
    if (index == no_operand) return nullptr;
    const Instruction& instruction = program_.instructions[index];
    if (instruction.opcode == Opcode::constant) {
        return stands_.at(stand(index, sort, lag)).kernel->result();
    }
    if (UniformDomain<D> || sorts_[index] == sort) return own(index);
    return stands_.at(stand(index, sort, instruction.lag)).kernel->result();
}

template <ValueDomain D>
std::size_t Wiring<D>::bytes() const noexcept {
    std::size_t bytes = 0;
    units_.each([&](const Unit& unit) { bytes += unit.kernel->bytes(); });
    for (const auto& queue : queues_)
        bytes += queue.bytes();
    return bytes;
}

} // namespace rtamt::dense
