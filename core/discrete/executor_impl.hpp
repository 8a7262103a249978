// The definitions of executor.hpp, for the files that instantiate it for a domain (real.cpp and its
// neighbours).
#pragma once

#include "executor.hpp"

#include "copy.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

namespace rtamt::discrete {

namespace detail {

// How many values of an output of this lag are known when the next slot is `slot`.
[[nodiscard]] inline std::int64_t known_before(std::int64_t slot, std::int64_t lag) noexcept {
    return std::max<std::int64_t>(slot - lag, 0);
}

// Of undefined values at one place the first instruction's: the others can only follow from it.
struct FirstUndefined {
    std::size_t place = Kernel::defined;
    std::uint32_t instruction = 0;

    [[nodiscard]] bool operator<(const FirstUndefined& other) const noexcept {
        return place < other.place || (place == other.place && instruction < other.instruction);
    }
};

} // namespace detail

template <ValueDomain D>
BasicExecutor<D>::BasicExecutor(Program program) : wiring_(std::move(program)) {}

template <ValueDomain D>
std::size_t BasicExecutor<D>::memory(const Program& program)
    requires UniformDomain<D>
{
    return Wiring<D>::memory(program);
}

template <ValueDomain D>
std::size_t BasicExecutor<D>::state_bytes() const noexcept {
    return wiring_.bytes();
}

template <ValueDomain D>
void BasicExecutor<D>::reserve(std::size_t count) {
    if (count <= wiring_.capacity() || wiring_.capacity() == Wiring<D>::block) return;
    wiring_.grow(last_);
    last_ = 0;
}

template <ValueDomain D>
std::size_t BasicExecutor<D>::known(std::size_t output, std::size_t count) const noexcept {
    const std::int64_t lag = program().instructions[program().outputs[output]].lag;
    return static_cast<std::size_t>(
        detail::known_before(slot_ + static_cast<std::int64_t>(count), lag) -
        detail::known_before(slot_, lag));
}

template <ValueDomain D>
std::size_t BasicExecutor<D>::remaining(std::size_t output) const noexcept {
    if (finished_) return 0;
    const std::int64_t lag = program().instructions[program().outputs[output]].lag;
    return static_cast<std::size_t>(slot_ - detail::known_before(slot_, lag));
}

template <ValueDomain D>
void BasicExecutor<D>::checkpoint(std::size_t count) noexcept {
    wiring_.numbers().checkpoint(last_);
    wiring_.formulas().checkpoint(last_);
    wiring_.units().checkpoint(count);
}

template <ValueDomain D>
void BasicExecutor<D>::rollback() noexcept {
    wiring_.numbers().rollback(last_);
    wiring_.formulas().rollback(last_);
    wiring_.units().rollback();
}

template <ValueDomain D>
void BasicExecutor<D>::load(Columns columns, std::size_t offset, const Block& block) noexcept {
    if (columns.empty()) return; // after the last sample
    const auto skips = [&](std::uint32_t input) { return zero_copy_ && zero_copy_->skips(input); };
    wiring_.numbers().load(columns, offset, block.count, skips);
    wiring_.formulas().load(columns, offset, block.count, skips);
}

// Returns whether no value is undefined.
template <ValueDomain D>
bool BasicExecutor<D>::run_guarded(const Block& block) noexcept {
    using detail::FirstUndefined;
    const auto failed = wiring_.units().run_guarded(FirstUndefined{}, [&](const Unit& unit) {
        const std::size_t place = unit.kernel->run(block);
        if (place == Kernel::defined) [[likely]] {
            return FirstUndefined{};
        }
        return FirstUndefined{place, unit.kernel->culprit(unit.instruction)};
    });
    if (!failed) [[likely]] {
        return true;
    }
    const auto& [unit, first] = *failed;
    failure_ = {first.instruction,
                block.slot + static_cast<std::int64_t>(first.place) -
                    program().instructions[first.instruction].lag,
                Fault(unit->kernel->fault())};
    return false;
}

template <ValueDomain D>
void BasicExecutor<D>::run_free(const Block& block) noexcept {
    wiring_.units().run_free([&](const Unit& unit) { (void)unit.kernel->run(block); });
}

// Has kernels read from the caller's columns and write to the caller's outputs where they can.
template <ValueDomain D>
void BasicExecutor<D>::bind_buffers(Columns columns, std::size_t offset, const Block& block,
                                    std::int64_t start, Outputs outputs) noexcept {
    if constexpr (UniformDomain<D>) {
        if (!zero_copy_) return;
        zero_copy_->bind_buffers(
            columns, offset, block,
            [&](std::size_t output, std::int64_t lag) {
                return outputs[output] + (block.slot - lag - detail::known_before(start, lag));
            },
            [&](std::size_t output) { return wiring_.output(output); });
    }
}

template <ValueDomain D>
void BasicExecutor<D>::deliver(const Block& block, std::int64_t start, Outputs outputs) noexcept {
    for (std::size_t output = 0; output < outputs.size(); ++output) {
        if (zero_copy_ && zero_copy_->written(output)) continue;
        const std::uint32_t instruction = program().outputs[output];
        const std::int64_t lag = program().instructions[instruction].lag;
        const Range present = block.present(lag);
        if (present.begin == present.end) continue;
        const std::int64_t offset = block.slot + static_cast<std::int64_t>(present.begin) - lag -
                                    detail::known_before(start, lag);
        copy_values(static_cast<const Formula*>(wiring_.output(output)) + present.begin,
                    present.end - present.begin, outputs[output] + offset);
    }
}

// How many of the next slots change nothing, because no value is present and every window is empty:
// after a short trace a long lag has many of them. A call may count its slots: it gets them all.
template <ValueDomain D>
std::size_t BasicExecutor<D>::idle(std::int64_t slot, std::size_t count) const noexcept {
    if (slot < samples_ || !program().calls.empty()) return 0;
    std::int64_t next = slot + static_cast<std::int64_t>(count);
    for (const Instruction& instruction : program().instructions) {
        if (instruction.lag > slot) {
            next = std::min(next, instruction.lag);
        } else if (slot < instruction.lag + samples_ + wiring_.memory_length()) {
            return 0;
        }
    }
    return static_cast<std::size_t>(next - slot);
}

// Runs everything over `count` slots. When `checked`, the guarded group cannot fail.
template <ValueDomain D>
bool BasicExecutor<D>::advance(Columns columns, std::size_t count, Outputs outputs,
                               bool checked) noexcept {
    const std::int64_t start = slot_;
    for (std::size_t offset = 0; offset < count;) {
        if (const std::size_t skipped = idle(slot_, count - offset); skipped != 0) {
            offset += skipped;
            slot_ += static_cast<std::int64_t>(skipped);
            continue;
        }
        const Block block{slot_, std::min(count - offset, longest_block()), samples_};
        load(columns, offset, block);
        bind_buffers(columns, offset, block, start, outputs);
        if (!run_guarded(block) && !checked) return false;
        run_free(block);
        deliver(block, start, outputs);
        last_ = std::min(block.count, wiring_.capacity()) - 1;
        offset += block.count;
        slot_ += static_cast<std::int64_t>(block.count);
    }
    return true;
}

// Looks for undefined values over `count` slots and takes everything back.
template <ValueDomain D>
bool BasicExecutor<D>::dry_run(Columns columns, std::size_t count) noexcept {
    wiring_.numbers().checkpoint(last_);
    wiring_.formulas().checkpoint(last_);
    const bool valid = wiring_.units().dry_run(
        [&] {
            for (std::size_t offset = 0; offset < count;) {
                const std::int64_t slot = slot_ + static_cast<std::int64_t>(offset);
                if (const std::size_t skipped = idle(slot, count - offset); skipped != 0) {
                    offset += skipped;
                    continue;
                }
                const Block block{slot, std::min(count - offset, wiring_.capacity()), samples_};
                load(columns, offset, block);
                if (!run_guarded(block)) return false;
                offset += block.count;
            }
            return true;
        },
        count);
    wiring_.numbers().rollback(last_);
    wiring_.formulas().rollback(last_);
    return valid;
}

template <ValueDomain D>
bool BasicExecutor<D>::update(Columns columns, std::size_t count, Outputs outputs) noexcept {
    if (count == 0) return true;
    if (!wiring_.units().can_fail()) return advance(columns, count, outputs, true);
    if (count > wiring_.capacity()) {
        return dry_run(columns, count) && advance(columns, count, outputs, true);
    }
    checkpoint(count);
    if (advance(columns, count, outputs, false)) return true;
    rollback();
    return false;
}

template <ValueDomain D>
Outcome BasicExecutor<D>::step(const Formula* row, Formula& value) noexcept
    requires UniformDomain<D>
{
    if (wiring_.units().can_fail()) checkpoint(1);
    wiring_.numbers().load(row);
    wiring_.formulas().load(row);
    const Block block{slot_, 1, samples_};
    if (!run_guarded(block)) [[unlikely]] {
        rollback();
        return Outcome::failed;
    }
    run_free(block);
    last_ = 0;
    const std::uint32_t output = program().outputs.front();
    if (slot_++ < program().instructions[output].lag) return Outcome::silent;
    value = *wiring_.output(0);
    return Outcome::known;
}

template <ValueDomain D>
std::optional<Failure> BasicExecutor<D>::push(Columns columns, std::size_t count, Outputs outputs) {
    if (finished_) {
        throw std::logic_error("The trace has ended: reset the monitor before the next sample.");
    }
    reserve(count);
    if (!update(columns, count, outputs)) return failure_;
    return std::nullopt;
}

template <ValueDomain D>
std::optional<Failure> BasicExecutor<D>::finish(Outputs outputs) {
    if (finished_) return std::nullopt;
    const auto rest = static_cast<std::size_t>(program().latest());
    reserve(rest);
    samples_ = slot_;
    if (!update({}, rest, outputs)) {
        samples_ = endless;
        return failure_;
    }
    finished_ = true;
    return std::nullopt;
}

template <ValueDomain D>
void BasicExecutor<D>::reset() noexcept {
    for (const auto& kernel : wiring_.kernels()) {
        if (kernel) kernel->reset();
    }
    slot_ = 0;
    samples_ = endless;
    finished_ = false;
}

template <ValueDomain D>
void BasicExecutor<D>::transfer(Snapshot& snapshot) {
    snapshot.item(slot_);
    snapshot.item(samples_);
    snapshot.item(finished_);
    snapshot.require(slot_ >= 0 && slot_ < endless / 2); // and so with many more samples
    snapshot.require(finished_ ? samples_ >= 0 && samples_ <= slot_ : samples_ == endless);
    for (const auto& kernel : wiring_.kernels()) {
        if (kernel) kernel->transfer(snapshot);
    }
    wiring_.each_value(last_, [&](auto& value) { snapshot.item(value); });
}

// Before up to `count` samples of a complete trace.
template <ValueDomain D>
void BasicExecutor<D>::begin_trace(std::size_t count) {
    if (slot_ != 0) reset();
    const std::size_t slots = std::max(count, static_cast<std::size_t>(program().latest()));
    if constexpr (UniformDomain<D>) {
        if (!zero_copy_) zero_copy_.emplace(program(), wiring_.reads(), wiring_.writes());
        if (zero_copy_->complete()) {
            wiring_.run_long_blocks();
        } else {
            wiring_.grow_for_trace(slots, zero_copy_->bypassed());
        }
    } else {
        reserve(slots);
    }
}

// After the last of its samples: `outputs` have room for `count` values that end with the trace.
template <ValueDomain D>
bool BasicExecutor<D>::end_trace(std::size_t count, Outputs outputs) {
    samples_ = slot_;
    if (program().latest() == 0) return true;
    std::vector<Formula*> tails;
    tails.reserve(outputs.size());
    for (std::size_t output = 0; output < outputs.size(); ++output) {
        tails.push_back(outputs[output] + (count - remaining(output)));
    }
    return advance({}, static_cast<std::size_t>(program().latest()), tails, false);
}

template <ValueDomain D>
std::optional<Failure> BasicExecutor<D>::evaluate(Columns columns, std::size_t count,
                                                  Outputs outputs) {
    begin_trace(count);
    if (!advance(columns, count, outputs, false) || !end_trace(count, outputs)) return failure_;
    return std::nullopt;
}

// In up to three runs: the first and the last make values of other parts known, too, which go to a
// buffer.
template <ValueDomain D>
std::optional<Failure> BasicExecutor<D>::evaluate(Columns columns, std::size_t count,
                                                  Outputs outputs, const Part& part) {
    const std::size_t first = part.begin - std::min(part.begin, part.before);
    const auto lag = [&](std::size_t output) {
        return static_cast<std::size_t>(program().instructions[program().outputs[output]].lag);
    };
    std::vector<Column> from;
    std::vector<Formula*> to(outputs.size());
    std::vector<Formula> buffer;
    begin_trace(part.end - first);
    // Runs up to a sample; values go to the buffer, and those of this part from there.
    const auto run = [&](std::size_t end, bool buffered) {
        const auto slot = static_cast<std::size_t>(slot_);
        const std::size_t begin = first + slot;
        const std::size_t samples = end - begin;
        from.assign(columns.begin(), columns.end());
        for (std::size_t i = 0; i < from.size(); ++i) {
            if constexpr (UniformDomain<D>) {
                from[i] += begin;
            } else if (input_sort(i) == Sort::number) {
                from[i] = static_cast<const Number*>(from[i]) + begin;
            } else {
                from[i] = static_cast<const Formula*>(from[i]) + begin;
            }
        }
        if (buffered) buffer.resize(outputs.size() * samples);
        for (std::size_t i = 0; i < to.size(); ++i) {
            to[i] = buffered ? buffer.data() + i * samples
                             : outputs[i] + first + (slot - std::min(slot, lag(i)));
        }
        if (!advance(from, samples, to, false)) return false;
        for (std::size_t i = 0; buffered && i < to.size(); ++i) {
            const std::size_t known = first + (slot - std::min(slot, lag(i)));
            const std::size_t known_end = end - std::min(end, lag(i));
            const std::size_t own = std::max(known, part.begin);
            const std::size_t own_end = std::min(known_end, part.end);
            if (own < own_end) {
                copy_values(to[i] + (own - known), own_end - own, outputs[i] + own);
            }
        }
        return true;
    };
    const std::size_t whole = std::min(part.begin + part.after, part.end);
    if (first < part.begin && !run(whole, true)) return failure_;
    if (!run(part.end, false)) return failure_;
    if (part.end == count) {
        if (!end_trace(count, outputs)) return failure_;
    } else if (part.after > 0 && !run(std::min(part.end + part.after, count), true)) {
        return failure_;
    }
    return std::nullopt;
}

template <ValueDomain D>
std::optional<Failure> BasicExecutor<D>::evaluate(Program program, Columns columns,
                                                  std::size_t count, Outputs outputs) {
    return BasicExecutor(std::move(program)).evaluate(columns, count, outputs);
}

template <ValueDomain D>
std::optional<typename BasicExecutor<D>::Formula>
BasicExecutor<D>::last(std::uint32_t instruction) const noexcept
    requires UniformDomain<D>
{
    if (slot_ == 0 || !wiring_.keeps(instruction)) return std::nullopt;
    return wiring_.value(instruction, last_);
}

} // namespace rtamt::discrete
