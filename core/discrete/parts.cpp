#include "parts.hpp"

#include "../program/threads.hpp"

#include <algorithm>
#include <atomic>

namespace rtamt::discrete {

namespace {

// Bounds beyond this are longer than any trace, and sums of a few of them are still numbers.
constexpr std::int64_t too_long = longest;

// How many slots before this one an instruction's operands are read at; nothing if at all slots.
[[nodiscard]] std::optional<std::int64_t> memory_of(const Instruction& instruction) noexcept {
    switch (instruction.opcode) {
    case Opcode::shift:
        return instruction.n;
    case Opcode::slide_max:
    case Opcode::slide_min:
    case Opcode::until:
    case Opcode::rank_max:
    case Opcode::rank_min:
        return instruction.n - 1;
    default:
        if (!info(instruction.opcode).pointwise && info(instruction.opcode).operands != 0) {
            return std::nullopt;
        }
        return 0;
    }
}

} // namespace

std::optional<Reach> reach(const Program& program) {
    if (!program.calls.empty()) return std::nullopt;
    // By instruction, the first slot at which a trace that begins in the middle of another has the
    // other's value.
    std::vector<std::int64_t> settled(program.instructions.size(), 0);
    for (std::size_t i = 0; i < settled.size(); ++i) {
        const Instruction& instruction = program.instructions[i];
        const auto memory = memory_of(instruction);
        if (!memory) return std::nullopt;
        settled[i] = instruction.lag;
        program.each_operand(instruction, [&](std::uint32_t operand) {
            settled[i] = std::max(settled[i], settled[operand] + *memory);
        });
        if (settled[i] > too_long) return std::nullopt;
    }
    Reach found{0, 0};
    for (std::size_t i = 0; i < settled.size(); ++i) {
        const std::int64_t lag = program.instructions[i].lag;
        found.before = std::max(found.before, settled[i] - lag);
        found.after = std::max(found.after, lag);
    }
    return found;
}

std::vector<std::size_t> parts(const Program& program, std::size_t count, std::size_t least) {
    constexpr std::size_t worthwhile = 8; // samples of a part for each that others read, too
    constexpr std::size_t line = 8;       // samples of a cache line, which only one part writes
    std::vector<std::size_t> places{0};
    if (count >= 2 * least) {
        if (const auto found = reach(program)) {
            const auto shared = static_cast<std::size_t>(found->before + found->after);
            const std::size_t pieces = count / std::max(least, worthwhile * shared);
            for (std::size_t i = 1; i < pieces; ++i)
                places.push_back(count / pieces * i / line * line);
        }
    }
    places.push_back(count);
    return places;
}

std::optional<Failure> evaluate_parts(const Program& program, std::span<const std::size_t> places,
                                      Executor::Columns columns, Executor::Outputs outputs,
                                      std::size_t threads, std::unique_ptr<Executor>& executor) {
    const std::size_t pieces = places.size() - 1;
    const std::size_t count = places.back();
    if (!executor) executor = std::make_unique<Executor>(program);
    std::atomic<bool> failed{false};
    if (pieces > 1) {
        const Reach shared = reach(program).value();
        std::vector<std::unique_ptr<Executor>> executors(
            std::clamp<std::size_t>(threads, 1, pieces));
        executors.front() = std::move(executor);
        for (auto& each : executors) {
            if (!each) each = std::make_unique<Executor>(program);
        }
        share_work(pieces, executors.size(), [&](std::size_t thread, std::size_t piece) {
            if (failed) return;
            const Part part{places[piece], places[piece + 1],
                            static_cast<std::size_t>(shared.before),
                            static_cast<std::size_t>(shared.after)};
            failed = executors[thread]->evaluate(columns, count, outputs, part) || failed;
        });
        if (!failed) {
            executor = std::move(executors.front());
            return std::nullopt;
        }
        // Which value is the first undefined one, if it is not before a part, is a question to the
        // whole trace.
        executor = std::make_unique<Executor>(program);
    }
    auto failure = executor->evaluate(columns, count, outputs);
    if (failure) executor.reset();
    return failure;
}

} // namespace rtamt::discrete
