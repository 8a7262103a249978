#include "executor.hpp"

#include "../cells.hpp"
#include "kernels.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

namespace rtamt::discrete {

namespace {

constexpr std::size_t block_size = 256;

// A cache line more than a block: else the same place of every register would fall into the same
// few cache sets.
constexpr std::size_t block_stride = block_size + 8;

[[nodiscard]] std::size_t checked_sum(std::size_t a, std::size_t b) {
    if (b > std::numeric_limits<std::size_t>::max() / sizeof(double) - a) {
        throw std::invalid_argument("This program needs more memory than can be addressed: make "
                                    "its time bounds smaller or its period longer.");
    }
    return a + b;
}

// How many values of an output of this lag are known when the next slot is `slot`.
[[nodiscard]] std::int64_t known_before(std::int64_t slot, std::int64_t lag) noexcept {
    return std::max<std::int64_t>(slot - lag, 0);
}

} // namespace

Executor::Plan Executor::plan(const Program& program) {
    const std::size_t size = program.instructions.size();
    Plan plan;
    plan.guarded.assign(size, false);
    for (std::size_t i = size; i-- > 0;) {
        const Instruction& instruction = program.instructions[i];
        if (program.can_fail(instruction)) plan.guarded[i] = true;
        if (!plan.guarded[i]) continue;
        program.each_operand(instruction,
                             [&](std::uint32_t operand) { plan.guarded[operand] = true; });
    }
    std::size_t total = size; // registers
    for (std::size_t i = 0; i < size; ++i) {
        const std::size_t state = state_size(program.instructions[i]);
        total = checked_sum(total, state);
        plan.state += state;
        if (plan.guarded[i]) {
            total = checked_sum(total, state);
            plan.journal += state;
        }
    }
    return plan;
}

Executor::Executor(Program program) : Executor{plan(program), std::move(program)} {}

Executor::Executor(const Plan& plan, Program program)
    : program_(std::move(program)), arena_(plan.state + plan.journal),
      registers_(program_.instructions.size()) {
    kernels_.reserve(program_.instructions.size());
    for (std::uint32_t i = 0; i < program_.instructions.size(); ++i) {
        const Instruction& instruction = program_.instructions[i];
        const std::size_t size = state_size(instruction);
        double* state = arena_.take(size);
        double* journal = plan.guarded[i] ? arena_.take(size) : nullptr;
        auto kernel =
            instruction.opcode == Opcode::call
                ? make_call(i)
                : make_kernel(
                      instruction, program_.operand_lag(instruction), state, journal,
                      {program_.is_constant(instruction.a), program_.is_constant(instruction.b)});
        if (kernel) {
            (plan.guarded[i] ? guarded_ : free_).push_back({kernel.get(), i});
            if (plan.guarded[i]) {
                fragile_.push_back({i, nullptr, 0.0});
                if (!info(instruction.opcode).pointwise) reversible_.push_back(kernel.get());
            }
        } else if (instruction.opcode == Opcode::input) {
            inputs_.push_back({i, static_cast<std::uint32_t>(instruction.n), nullptr});
            fragile_.push_back({i, nullptr, 0.0});
        }
        kernels_.push_back(std::move(kernel));
        if (size != 0) longest_ = std::max(longest_, instruction.n);
    }
    if (guarded_.empty()) fragile_.clear();
    connect();
}

std::unique_ptr<Kernel> Executor::make_call(std::uint32_t index) {
    const Instruction& instruction = program_.instructions[index];
    const CallSite& site = program_.calls[static_cast<std::size_t>(instruction.n)];
    auto kernel = std::make_unique<Call>(*site.kernel, site.setup,
                                         program_.operand_lag(instruction), instruction.lag);
    calls_.emplace_back(kernel.get(), index);
    return kernel;
}

std::size_t Executor::memory(const Program& program) {
    const Plan sizes = plan(program);
    return (sizes.state + sizes.journal + program.instructions.size()) * sizeof(double);
}

std::size_t Executor::state_bytes() const noexcept {
    return arena_.bytes() + registers_.size() * sizeof(double);
}

double* Executor::register_of(std::uint32_t instruction) noexcept {
    return registers_.data() + instruction * stride_;
}

const double* Executor::register_of(std::uint32_t instruction) const noexcept {
    return registers_.data() + instruction * stride_;
}

void Executor::connect() {
    for (std::uint32_t i = 0; i < kernels_.size(); ++i) {
        const Instruction& instruction = program_.instructions[i];
        if (instruction.opcode == Opcode::constant) {
            std::fill_n(register_of(i), capacity_, instruction.x);
        } else if (kernels_[i]) {
            kernels_[i]->connect(instruction.a == no_operand ? nullptr : register_of(instruction.a),
                                 instruction.b == no_operand ? nullptr : register_of(instruction.b),
                                 register_of(i));
        }
    }
    for (const auto& [call, index] : calls_) {
        std::vector<const double*> registers;
        program_.each_operand(program_.instructions[index], [&](std::uint32_t operand) {
            registers.push_back(register_of(operand));
        });
        call->connect_operands(std::move(registers));
    }
    for (Input& input : inputs_)
        input.values = register_of(input.instruction);
    for (Fragile& fragile : fragile_)
        fragile.values = register_of(fragile.instruction);
}

void Executor::reserve(std::size_t count) {
    if (count <= capacity_ || capacity_ == block_size) return;
    std::vector<double> larger(program_.instructions.size() * block_stride);
    for (std::uint32_t i = 0; i < program_.instructions.size(); ++i) {
        larger[i * block_stride] = register_of(i)[last_];
    }
    registers_ = std::move(larger);
    capacity_ = block_size;
    stride_ = block_stride;
    last_ = 0;
    connect();
}

std::size_t Executor::known(std::size_t output, std::size_t count) const noexcept {
    const std::int64_t lag = program_.instructions[program_.outputs[output]].lag;
    return static_cast<std::size_t>(known_before(slot_ + static_cast<std::int64_t>(count), lag) -
                                    known_before(slot_, lag));
}

std::size_t Executor::remaining(std::size_t output) const noexcept {
    if (finished_) return 0;
    const std::int64_t lag = program_.instructions[program_.outputs[output]].lag;
    return static_cast<std::size_t>(slot_ - known_before(slot_, lag));
}

void Executor::checkpoint(std::size_t count) noexcept {
    for (Fragile& fragile : fragile_)
        fragile.last = fragile.values[last_];
    for (Kernel* kernel : reversible_)
        kernel->checkpoint(count);
}

void Executor::rollback() noexcept {
    for (const Fragile& fragile : fragile_)
        fragile.values[last_] = fragile.last;
    for (Kernel* kernel : reversible_)
        kernel->rollback();
}

void Executor::load(std::span<const double* const> columns, std::size_t offset,
                    const Block& block) noexcept {
    if (columns.empty()) return; // after the last sample
    for (const Input& input : inputs_) {
        if (direct_.skips(input.instruction)) continue;
        copy_cells(columns[input.column] + offset, block.count, input.values);
    }
}

// Of all values that are NaN the one of the lowest slot, then of the first instruction: whatever
// else is NaN in this block can only follow from it.
bool Executor::run_guarded(const Block& block) noexcept {
    std::size_t first = Kernel::defined;
    const Unit* culprit = nullptr;
    for (const Unit& unit : guarded_) {
        const std::size_t place = unit.kernel->run(block);
        if (place < first) [[unlikely]] {
            first = place;
            culprit = &unit;
        }
    }
    if (first == Kernel::defined) [[likely]] {
        return true;
    }
    const std::uint32_t instruction = culprit->instruction;
    failure_ = {instruction,
                block.slot + static_cast<std::int64_t>(first) -
                    program_.instructions[instruction].lag,
                Fault(culprit->kernel->fault())};
    return false;
}

void Executor::run_free(const Block& block) noexcept {
    for (const Unit& unit : free_)
        unit.kernel->run(block);
}

// Has kernels read from the caller's columns and write to the caller's outputs where they can.
void Executor::aim(std::span<const double* const> columns, std::size_t offset, const Block& block,
                   std::int64_t start, std::span<double* const> outputs) noexcept {
    direct_.aim(
        columns, offset, block,
        [&](std::size_t output, std::int64_t lag) {
            return outputs[output] + (block.slot - lag - known_before(start, lag));
        },
        [&](std::size_t output) { return register_of(program_.outputs[output]); });
}

void Executor::deliver(const Block& block, std::int64_t start,
                       std::span<double* const> outputs) noexcept {
    for (std::size_t output = 0; output < outputs.size(); ++output) {
        if (direct_.written(output)) continue;
        const std::uint32_t instruction = program_.outputs[output];
        const std::int64_t lag = program_.instructions[instruction].lag;
        const Range present = block.present(lag);
        if (present.begin == present.end) continue;
        const std::int64_t offset =
            block.slot + static_cast<std::int64_t>(present.begin) - lag - known_before(start, lag);
        copy_cells(register_of(instruction) + present.begin, present.end - present.begin,
                   outputs[output] + offset);
    }
}

// How many of the next slots change nothing, because no value is present and every window is empty:
// after a short trace a long lag has many of them. A call may count its slots: it gets them all.
std::size_t Executor::idle(std::int64_t slot, std::size_t count) const noexcept {
    if (slot < samples_ || !calls_.empty()) return 0;
    std::int64_t next = slot + static_cast<std::int64_t>(count);
    for (const Instruction& instruction : program_.instructions) {
        if (instruction.lag > slot) {
            next = std::min(next, instruction.lag);
        } else if (slot < instruction.lag + samples_ + longest_) {
            return 0;
        }
    }
    return static_cast<std::size_t>(next - slot);
}

// Runs everything over `count` slots. When `checked`, the guarded group cannot fail.
bool Executor::advance(std::span<const double* const> columns, std::size_t count,
                       std::span<double* const> outputs, bool checked) noexcept {
    const std::int64_t start = slot_;
    for (std::size_t offset = 0; offset < count;) {
        if (const std::size_t skipped = idle(slot_, count - offset); skipped != 0) {
            offset += skipped;
            slot_ += static_cast<std::int64_t>(skipped);
            continue;
        }
        const Block block{slot_, std::min(count - offset, capacity_), samples_};
        load(columns, offset, block);
        aim(columns, offset, block, start, outputs);
        if (!run_guarded(block) && !checked) return false;
        run_free(block);
        deliver(block, start, outputs);
        last_ = block.count - 1;
        offset += block.count;
        slot_ += static_cast<std::int64_t>(block.count);
    }
    return true;
}

// Looks for NaN over `count` slots and takes everything back.
bool Executor::survey(std::span<const double* const> columns, std::size_t count) noexcept {
    checkpoint(count);
    bool sound = true;
    for (std::size_t offset = 0; sound && offset < count;) {
        const std::int64_t slot = slot_ + static_cast<std::int64_t>(offset);
        if (const std::size_t skipped = idle(slot, count - offset); skipped != 0) {
            offset += skipped;
            continue;
        }
        const Block block{slot, std::min(count - offset, capacity_), samples_};
        load(columns, offset, block);
        sound = run_guarded(block);
        offset += block.count;
    }
    rollback();
    return sound;
}

bool Executor::update(std::span<const double* const> columns, std::size_t count,
                      std::span<double* const> outputs) noexcept {
    if (count == 0) return true;
    if (guarded_.empty()) return advance(columns, count, outputs, true);
    if (count > capacity_) {
        return survey(columns, count) && advance(columns, count, outputs, true);
    }
    checkpoint(count);
    if (advance(columns, count, outputs, false)) return true;
    rollback();
    return false;
}

Outcome Executor::step(const double* row, double& value) noexcept {
    if (!guarded_.empty()) checkpoint(1);
    for (const Input& input : inputs_)
        *input.values = row[input.column];
    const Block block{slot_, 1, samples_};
    if (!run_guarded(block)) [[unlikely]] {
        rollback();
        return Outcome::failed;
    }
    run_free(block);
    last_ = 0;
    const std::uint32_t output = program_.outputs.front();
    if (slot_++ < program_.instructions[output].lag) return Outcome::silent;
    value = *register_of(output);
    return Outcome::known;
}

std::optional<Failure> Executor::push(std::span<const double* const> columns, std::size_t count,
                                      std::span<double* const> outputs) {
    if (finished_) {
        throw std::logic_error("The trace has ended: reset the monitor before the next sample.");
    }
    reserve(count);
    if (!update(columns, count, outputs)) return failure_;
    return std::nullopt;
}

std::optional<Failure> Executor::finish(std::span<double* const> outputs) {
    if (finished_) return std::nullopt;
    const auto rest = static_cast<std::size_t>(program_.latest());
    reserve(rest);
    samples_ = slot_;
    if (!update({}, rest, outputs)) {
        samples_ = endless;
        return failure_;
    }
    finished_ = true;
    return std::nullopt;
}

void Executor::reset() noexcept {
    for (const auto& kernel : kernels_) {
        if (kernel) kernel->reset();
    }
    slot_ = 0;
    samples_ = endless;
    finished_ = false;
}

void Executor::transfer(Snapshot& snapshot) {
    snapshot.item(slot_);
    snapshot.item(samples_);
    snapshot.item(finished_);
    snapshot.require(slot_ >= 0 && slot_ < endless / 2); // and so with many more samples
    snapshot.require(finished_ ? samples_ >= 0 && samples_ <= slot_ : samples_ == endless);
    for (const auto& kernel : kernels_) {
        if (kernel) kernel->transfer(snapshot);
    }
    for (std::uint32_t i = 0; i < kernels_.size(); ++i)
        snapshot.item(register_of(i)[last_]);
}

std::optional<Failure> Executor::evaluate(Program program, std::span<const double* const> columns,
                                          std::size_t count, std::span<double* const> outputs) {
    Executor executor(std::move(program));
    const auto rest = static_cast<std::size_t>(executor.program_.latest());
    executor.reserve(std::max(count, rest));
    executor.direct_ = Direct(executor.program_, executor.kernels_);
    if (!executor.advance(columns, count, outputs, false)) return executor.failure_;
    executor.samples_ = executor.slot_;
    std::vector<double*> tails;
    tails.reserve(outputs.size());
    for (std::size_t output = 0; output < outputs.size(); ++output) {
        tails.push_back(outputs[output] + (count - executor.remaining(output)));
    }
    if (!executor.advance({}, rest, tails, false)) return executor.failure_;
    return std::nullopt;
}

double Executor::last(std::uint32_t instruction) const noexcept {
    if (slot_ == 0) return std::numeric_limits<double>::quiet_NaN();
    return register_of(instruction)[last_];
}

} // namespace rtamt::discrete
