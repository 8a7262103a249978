// What a program means in dense time, straight from the definition of each opcode.
//
// All times, widths, distances and lags are whole ticks, so that every signal is constant on
// [k, k + 1): a signal is a list of one value a tick, and what the definition says of the instants
// of a tick is said for its first instant and holds for the others. Nothing is kept or clever.
#pragma once

#include "dense/events.hpp"
#include "discrete/oracle.hpp"
#include "program/program.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace dense_oracle {

using oracle::inf;
using oracle::Random;
using oracle::Slots;
using rtamt::Instruction;
using rtamt::Opcode;
using rtamt::Program;

struct Signal {
    std::vector<std::int64_t> times;
    std::vector<double> values;

    [[nodiscard]] bool operator==(const Signal&) const = default;
    [[nodiscard]] std::size_t size() const { return times.size(); }
    [[nodiscard]] rtamt::dense::Events events(std::size_t begin, std::size_t count) const {
        return {times.data() + begin, values.data() + begin, count};
    }
    void add(std::int64_t time, double value) {
        times.push_back(time);
        values.push_back(value);
    }
    // The same without events that change nothing, and without those after a time.
    [[nodiscard]] Signal merged(std::int64_t until = rtamt::dense::never) const {
        Signal result;
        for (std::size_t i = 0; i < size() && times[i] <= until; ++i) {
            if (result.values.empty() || result.values.back() != values[i]) {
                result.add(times[i], values[i]);
            }
        }
        return result;
    }
    // Only the first `count` events.
    [[nodiscard]] Signal first(std::size_t count) const {
        Signal result;
        for (std::size_t i = 0; i < count; ++i)
            result.add(times[i], values[i]);
        return result;
    }
};

inline Signal signal_of(const rtamt::dense::Events& events) {
    return {{events.times, events.times + events.count},
            {events.values, events.values + events.count}};
}

using Trace = std::vector<Signal>;

struct Undefined {
    std::uint32_t instruction;
    std::int64_t time;
    std::int64_t arrival;
};

struct Answer {
    std::vector<Signal> outputs; // merged
    std::optional<Undefined> undefined;
};

inline std::int64_t start_of(const Trace& trace) {
    std::int64_t start = trace[0].times.front();
    for (const Signal& signal : trace)
        start = std::max(start, signal.times.front());
    return start;
}

inline std::int64_t frontier_of(const Trace& trace) {
    std::int64_t frontier = trace[0].times.back();
    for (const Signal& signal : trace)
        frontier = std::min(frontier, signal.times.back());
    return frontier;
}

inline std::int64_t end_of(const Trace& trace) {
    std::int64_t end = trace[0].times.back();
    for (const Signal& signal : trace)
        end = std::max(end, signal.times.back());
    return end;
}

inline double at(const Signal& signal, std::int64_t time) {
    double value = 0;
    for (std::size_t i = 0; i < signal.size() && signal.times[i] <= time; ++i)
        value = signal.values[i];
    return value;
}

// Up to which arrival after the end of the trace the values of an instruction are needed.
inline std::int64_t reach(const Program& program, std::uint32_t index) {
    std::int64_t longest = program.instructions[index].lag;
    for (std::uint32_t reader = index + 1; reader < program.instructions.size(); ++reader) {
        const Instruction& instruction = program.instructions[reader];
        if (instruction.a != index && instruction.b != index) continue;
        const std::int64_t past = instruction.opcode == Opcode::shift ? instruction.n : 0;
        longest = std::max(longest, reach(program, reader) - past);
    }
    return longest;
}

// How many ticks of a window are positive; several in a row are infinitely many.
inline double pulses(const Slots& a, std::int64_t first, std::int64_t last) {
    const auto positive = [&](std::int64_t s) {
        return a[static_cast<std::size_t>(s)].value_or(0.0) > 0;
    };
    double count = 0;
    for (std::int64_t s = first; s <= last; ++s) {
        if (positive(s)) count += s > first && positive(s - 1) ? inf : 1.0;
    }
    return count;
}

// One tick of an instruction with state, given all ticks of its operands up to it.
inline double temporal(const Instruction& instruction, const Slots& a, const Slots& b,
                       std::int64_t tick) {
    const auto value_at = [](const Slots& slots, std::int64_t s) {
        return slots[static_cast<std::size_t>(s)];
    };
    const std::int64_t window = std::max<std::int64_t>(0, tick - instruction.n);
    double best = -inf;
    double least = inf;
    switch (instruction.opcode) {
    case Opcode::shift:
        if (tick < instruction.n) return instruction.x;
        return value_at(a, tick - instruction.n).value_or(instruction.x);
    case Opcode::slide_max:
        for (std::int64_t s = window; s <= tick; ++s)
            best = std::max(best, value_at(a, s).value_or(-inf));
        return best;
    case Opcode::slide_min:
        for (std::int64_t s = window; s <= tick; ++s)
            least = std::min(least, value_at(a, s).value_or(inf));
        return least;
    case Opcode::run_max:
        for (std::int64_t s = 0; s <= tick; ++s)
            best = std::max(best, value_at(a, s).value_or(-inf));
        return best;
    case Opcode::run_min:
        for (std::int64_t s = 0; s <= tick; ++s)
            least = std::min(least, value_at(a, s).value_or(inf));
        return least;
    case Opcode::slide_sum:
        return pulses(a, window, tick);
    case Opcode::run_sum:
        return pulses(a, 0, tick);
    case Opcode::since: // t' = tick itself, where (t', t] is empty; then t' inside earlier ticks,
                        // where it contains the rest of that tick
        best = value_at(b, tick).value_or(-inf);
        for (std::int64_t s = tick; s >= 0; --s) {
            least = std::min(least, value_at(a, s).value_or(inf));
            best = std::max(best, std::min(value_at(b, s).value_or(-inf), least));
        }
        return best;
    case Opcode::until: // the best psi in the window, with phi from its start to just before
        for (std::int64_t s = window; s <= tick; ++s) {
            best = std::max(best, std::min(value_at(b, s).value_or(-inf), least));
            least = std::min(least, value_at(a, s).value_or(inf));
        }
        return best;
    default:
        return std::numeric_limits<double>::quiet_NaN();
    }
}

// The last values hold for `extra` ticks more. Ticks are counted from the start of the trace.
inline Answer answer(const Program& program, const Trace& trace, std::int64_t extra = 0) {
    const std::int64_t start = start_of(trace);
    const std::int64_t end = end_of(trace) + extra - start; // from here on, times count from start
    const std::int64_t ticks = end + program.latest() + 1;
    std::vector<Slots> values(program.instructions.size());
    Answer answer;
    for (std::uint32_t i = 0; i < values.size(); ++i) {
        const Instruction& instruction = program.instructions[i];
        // A constant has no time: it is there whenever the other operand is.
        const auto operand = [&](std::uint32_t index) {
            if (index == rtamt::no_operand) return Slots{};
            Slots slots = values[index];
            if (program.instructions[index].opcode != Opcode::constant) return slots;
            const std::int64_t lag = program.operand_lag(instruction);
            for (std::int64_t s = 0; s < std::min(lag, ticks); ++s)
                slots[static_cast<std::size_t>(s)].reset();
            return slots;
        };
        const Slots a = operand(instruction.a);
        const Slots b = operand(instruction.b);
        const std::int64_t needed = end + reach(program, i);
        for (std::int64_t s = 0; s < ticks; ++s) {
            values[i].emplace_back();
            if (s < instruction.lag) continue;
            double value = 0;
            if (instruction.opcode == Opcode::input) {
                value = at(trace[static_cast<std::size_t>(instruction.n)], start + s);
            } else if (instruction.opcode == Opcode::constant) {
                value = instruction.x;
            } else if (rtamt::info(instruction.opcode).pointwise) {
                const auto place = static_cast<std::size_t>(s);
                value = oracle::pointwise(instruction.opcode, *a[place], b.empty() ? 0 : *b[place]);
            } else {
                value = temporal(instruction, a, b, s);
            }
            if (std::isnan(value) && s <= needed &&
                (!answer.undefined || start + s < answer.undefined->arrival)) {
                answer.undefined = {i, start + s - instruction.lag, start + s};
            }
            values[i].back() = value;
        }
    }
    for (const std::uint32_t output : program.outputs) {
        Signal signal;
        const std::int64_t lag = program.instructions[output].lag;
        for (std::int64_t t = 0; t <= end; ++t)
            signal.add(start + t, *values[output][static_cast<std::size_t>(t + lag)]);
        answer.outputs.push_back(signal.merged());
    }
    return answer;
}

// Events at random: gaps of one tick and longer ones, ties with other signals, equal neighbours.
inline Signal random_signal(Random& random, std::int64_t begin, std::size_t count,
                            int infinite_percent = 2) {
    Signal signal;
    std::int64_t time = begin;
    const std::int64_t gap = random.chance(50) ? 2 : 9;
    for (std::size_t i = 0; i < count; ++i) {
        signal.add(time, random.number(infinite_percent));
        time += random.chance(40) ? 1 : random.between(1, gap);
    }
    return signal;
}

inline Trace random_trace(Random& random, std::size_t inputs, std::size_t events,
                          std::int64_t base = 0, int infinite_percent = 2) {
    Trace trace;
    for (std::size_t i = 0; i < inputs; ++i) {
        const std::int64_t begin = base + (random.chance(50) ? 0 : random.between(0, 12));
        trace.push_back(random_signal(
            random, begin, static_cast<std::size_t>(random.between(1, static_cast<int>(events))),
            infinite_percent));
    }
    return trace;
}

} // namespace dense_oracle
