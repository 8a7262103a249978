// What a program means, straight from the definition of each opcode: every slot of every
// instruction from all slots before it, with nothing kept and nothing clever.
#pragma once

#include "program/program.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <vector>

namespace oracle {

using rtamt::Instruction;
using rtamt::Opcode;
using rtamt::Program;
using Signal = std::vector<double>;
using Slots = std::vector<std::optional<double>>; // nothing where absent

constexpr double inf = std::numeric_limits<double>::infinity();

struct Answer {
    std::vector<Signal> outputs;
    // The first slot with an undefined value, and its first instruction.
    std::optional<std::pair<std::uint32_t, std::int64_t>> undefined; // instruction, sample
    std::int64_t undefined_slot = 0;
};

inline double pointwise(Opcode opcode, double a, double b) {
    switch (opcode) {
    case Opcode::neg:
        return -a;
    case Opcode::abs:
        return a < 0 ? -a : a;
    case Opcode::sqrt:
        return std::sqrt(a);
    case Opcode::exp:
        return std::exp(a);
    case Opcode::ln:
        return std::log(a);
    case Opcode::add:
        return a + b;
    case Opcode::sub:
        return a - b;
    case Opcode::mul:
        return a * b;
    case Opcode::div:
        return a / (b == 0 ? 0.0 : b);
    case Opcode::pow:
        return std::pow(a == 0 ? 0.0 : a, b);
    case Opcode::log:
        return std::log(a) / std::log(b);
    case Opcode::sin:
        return std::sin(a);
    case Opcode::cos:
        return std::cos(a);
    case Opcode::tan:
        return std::tan(a);
    case Opcode::asin:
        return std::asin(a);
    case Opcode::acos:
        return std::acos(a);
    case Opcode::atan:
        return std::atan(a);
    case Opcode::atan2:
        return std::atan2(a == 0 ? 0.0 : a, b == 0 ? 0.0 : b);
    case Opcode::hypot:
        return std::hypot(a, b);
    case Opcode::sinh:
        return std::sinh(a);
    case Opcode::cosh:
        return std::cosh(a);
    case Opcode::tanh:
        return std::tanh(a);
    case Opcode::degrees:
        return a * 57.29577951308232;
    case Opcode::radians:
        return a * 0.017453292519943295;
    case Opcode::floor:
        return a - std::fmod(a, 1) - (std::fmod(a, 1) < 0 ? 1 : 0);
    case Opcode::ceil:
        return a - std::fmod(a, 1) + (std::fmod(a, 1) > 0 ? 1 : 0);
    case Opcode::round:
        return std::trunc(a) + (std::fabs(std::fmod(a, 1)) >= 0.5 ? std::copysign(1.0, a) : 0.0);
    case Opcode::sign:
        return a > 0 ? 1 : a < 0 ? -1 : 0;
    case Opcode::mod:
        return std::fmod(a, b) * b < 0 ? std::fmod(a, b) + b : std::fmod(a, b);
    case Opcode::at_least:
        return a < b ? std::numeric_limits<double>::quiet_NaN() : a;
    case Opcode::min:
        return std::min(a, b);
    case Opcode::max:
        return std::max(a, b);
    case Opcode::holds_gt:
        return a > b ? inf : -inf;
    case Opcode::holds_ge:
        return a >= b ? inf : -inf;
    case Opcode::holds_eq:
        return a == b ? inf : -inf;
    default:
        return std::numeric_limits<double>::quiet_NaN();
    }
}

// The last `width` samples in blocks of as many, from the first one on: the end of one block, added
// backwards, and the begin of the next.
inline double sum(const Slots& a, std::int64_t slot, std::int64_t width) {
    std::vector<double> samples;
    for (std::int64_t s = 0; s <= slot; ++s) {
        const auto& sample = a[static_cast<std::size_t>(s)];
        if (sample) samples.push_back(*sample);
    }
    if (samples.empty()) return 0;
    const std::size_t last = samples.size() - 1;
    const auto wide = static_cast<std::size_t>(width);
    const std::size_t block = last / wide * wide;
    double ending = 0;
    double beginning = 0;
    for (std::size_t i = block; i <= last; ++i)
        beginning += samples[i];
    const std::size_t first = last + 1 > wide ? last + 1 - wide : 0;
    for (std::size_t i = block; i > first; --i)
        ending += samples[i - 1];
    return ending + beginning;
}

// One slot of an instruction with state, given all slots of its operands up to it.
inline double temporal(const Instruction& instruction, const Slots& a, const Slots& b,
                       std::int64_t slot) {
    const auto at = [](const Slots& slots, std::int64_t s) {
        return slots[static_cast<std::size_t>(s)];
    };
    const std::int64_t window = std::max<std::int64_t>(0, slot - instruction.n + 1);
    double value = 0;
    switch (instruction.opcode) {
    case Opcode::shift:
        if (slot < instruction.n) return instruction.x;
        return at(a, slot - instruction.n).value_or(instruction.x);
    case Opcode::slide_max:
        value = -inf;
        for (std::int64_t s = window; s <= slot; ++s)
            value = std::max(value, at(a, s).value_or(-inf));
        return value;
    case Opcode::slide_min:
        value = inf;
        for (std::int64_t s = window; s <= slot; ++s)
            value = std::min(value, at(a, s).value_or(inf));
        return value;
    case Opcode::run_max:
        value = -inf;
        for (std::int64_t s = 0; s <= slot; ++s)
            value = std::max(value, at(a, s).value_or(-inf));
        return value;
    case Opcode::run_min:
        value = inf;
        for (std::int64_t s = 0; s <= slot; ++s)
            value = std::min(value, at(a, s).value_or(inf));
        return value;
    case Opcode::slide_sum:
        return sum(a, slot, instruction.n);
    case Opcode::run_sum:
        return sum(a, slot, slot + 1);
    case Opcode::since: // the best psi so far, held since by phi
        value = -inf;
        for (std::int64_t s = 0; s <= slot; ++s) {
            if (!at(b, s)) continue;
            double held = *at(b, s);
            for (std::int64_t r = s + 1; r <= slot; ++r)
                held = std::min(held, at(a, r).value_or(inf));
            value = std::max(value, held);
        }
        return value;
    case Opcode::until: // the best psi in the window, with phi from its start to just before
        value = -inf;
        for (std::int64_t s = window; s <= slot; ++s) {
            if (!at(b, s)) continue;
            double held = *at(b, s);
            for (std::int64_t r = window; r < s; ++r)
                held = std::min(held, at(a, r).value_or(inf));
            value = std::max(value, held);
        }
        return value;
    default:
        return std::numeric_limits<double>::quiet_NaN();
    }
}

inline Answer answer(const Program& program, const std::vector<Signal>& columns,
                     std::size_t count) {
    const auto samples = static_cast<std::int64_t>(count);
    const std::int64_t end = samples + program.latest();
    std::vector<Slots> values(program.instructions.size());
    Answer answer;
    const Slots none;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const Instruction& instruction = program.instructions[i];
        const auto operand = [&](std::uint32_t index) -> const Slots& {
            return index == rtamt::no_operand ? none : values[index];
        };
        // A constant has no time: it is there whenever the other operand is.
        const auto timed = [&](std::uint32_t index) {
            Slots slots = operand(index);
            if (index == rtamt::no_operand) return slots;
            if (program.instructions[index].opcode != Opcode::constant) return slots;
            const std::int64_t lag = program.operand_lag(instruction);
            for (std::int64_t s = 0; s < end; ++s) {
                slots[static_cast<std::size_t>(s)].reset();
                if (s >= lag && s < lag + samples) {
                    slots[static_cast<std::size_t>(s)] = program.instructions[index].x;
                }
            }
            return slots;
        };
        const Slots a = timed(instruction.a);
        const Slots b = timed(instruction.b);
        for (std::int64_t s = 0; s < end; ++s) {
            const std::int64_t time = s - instruction.lag;
            values[i].emplace_back();
            if (time < 0 || time >= samples) continue;
            double value = 0;
            if (instruction.opcode == Opcode::input) {
                value =
                    columns[static_cast<std::size_t>(instruction.n)][static_cast<std::size_t>(s)];
            } else if (instruction.opcode == Opcode::constant) {
                value = instruction.x;
            } else if (rtamt::info(instruction.opcode).pointwise) {
                const auto place = static_cast<std::size_t>(s);
                value = pointwise(instruction.opcode, *a[place], b.empty() ? 0 : *b[place]);
            } else {
                value = temporal(instruction, a, b, s);
            }
            if (std::isnan(value) && (!answer.undefined || s < answer.undefined_slot)) {
                answer.undefined = {static_cast<std::uint32_t>(i), time};
                answer.undefined_slot = s;
            }
            values[i].back() = value;
        }
    }
    for (const std::uint32_t output : program.outputs) {
        Signal signal;
        for (const auto& value : values[output]) {
            if (value) signal.push_back(*value);
        }
        answer.outputs.push_back(signal);
    }
    return answer;
}

// Numbers of which many are equal, some infinite, and some zero.
class Random {
  public:
    explicit Random(std::uint32_t seed) : engine_(seed) {}

    std::int64_t between(std::int64_t low, std::int64_t high) {
        return std::uniform_int_distribution<std::int64_t>(low, high)(engine_);
    }
    bool chance(int percent) { return between(1, 100) <= percent; }
    double number(int infinite_percent) {
        if (chance(infinite_percent)) return chance(50) ? inf : -inf;
        return static_cast<double>(between(-40, 40)) / 4;
    }
    Signal signal(std::size_t count, int infinite_percent = 2) {
        Signal signal;
        for (std::size_t i = 0; i < count; ++i)
            signal.push_back(number(infinite_percent));
        return signal;
    }

  private:
    std::mt19937 engine_;
};

} // namespace oracle
