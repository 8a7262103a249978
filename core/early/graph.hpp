// A formula as the early engines run it: nodes over absolute time, operands first.
//
// A reference to a node is twice its index, plus one where the formula is negated: the registers of
// a node hold its lower bounds and its negated upper bounds, so that negation exchanges them.
//
//     kind         value at t, with w = [t + low, t + high] all before t or all after it
//     atom         an expression over the inputs at t
//     map          a function of a and b at t
//     both         the smaller of a and b
//     either       the larger of a and b
//     least        the least value of a in w; w is cut at the start, and may have no end
//     greatest     the greatest value of a in w
//     until        max(b, min(a, own value at t + 1))
//     since        max(b, min(a, own value at t - 1))
//     since_dense  min(a, max(b, own value at t - 1)): in dense time the rest of the tick counts
//     rank_least   the c-th smallest value of a at [t + low, t + high], +inf where there are fewer;
//                  c is the constant of the only step
//     rank_greatest  the c-th greatest, -inf where there are fewer
//     held         a at t + low; before the start its first value, after the end its last
//     pulses       at how many ticks of w, behind t, a is positive: in dense time, where a is a
//     pulse
//                  of one tick; a run of which w has more than one tick counts as infinitely many
//     sum          the sum of a over w, behind t and cut at the start, in the order of
//     window_sums.hpp
#pragma once

#include "../program/opcodes.hpp"
#include "../values/interval.hpp"
#include "runs.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace rtamt::early {

inline constexpr std::uint32_t none = 0xFFFFFFFFU;

enum class Kind : std::uint8_t {
    atom,
    map,
    both,
    either,
    least,
    greatest,
    until,
    since,
    since_dense,
    held,
    sum,
    rank_least,
    rank_greatest,
    pulses,
};

// One operation of an expression; operands are earlier steps.
struct Step {
    Opcode opcode{};
    std::uint32_t a = none; // of an input: which one
    std::uint32_t b = none;
    double x = 0.0; // value of a constant
};

struct Node {
    Kind kind{};
    std::uint32_t a = none; // references
    std::uint32_t b = none;
    Tick low = 0;
    Tick high = 0;
    Tick horizon = 0;        // how many ticks later the value is final; may be `forever`
    std::vector<Step> steps; // of atoms; of maps one, over operands 0 and 1; of sums one, the sum
};

struct Graph {
    std::vector<Node> nodes;
    std::uint32_t inputs = 0;

    // Throws std::invalid_argument unless references point backwards and steps are complete.
    void check() const;

    // By node, whether its values are infinite, which are those of truth.
    [[nodiscard]] std::vector<bool> truths() const;
};

// What an operation makes of one or two operands.
[[nodiscard]] double compute(Opcode opcode, double a, double b) noexcept;
[[nodiscard]] Bounds compute(Opcode opcode, const Bounds& a, const Bounds& b) noexcept;

// The index of the step that has no value, or none. `results` has a place for each step.
template <class Value>
[[nodiscard]] std::uint32_t run(std::span<const Step> steps, std::span<const Value> inputs,
                                std::span<Value> results) noexcept;

// The same, where a step without a value may have any.
struct Wrong {
    std::uint32_t any = none;   // the first such step
    std::uint32_t exact = none; // the first one whose operands are known exactly
};
[[nodiscard]] Wrong enclose(std::span<const Step> steps, std::span<const Bounds> inputs,
                            std::span<Bounds> results) noexcept;

} // namespace rtamt::early
