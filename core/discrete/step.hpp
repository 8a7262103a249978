// The steps that a chain of operations on doubles consists of, and what they work on.
//
// Memory: twelve bytes a step.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace rtamt::discrete {

// What a step does to the accumulator x and its operand y; `_back`: with both exchanged; `_both`:
// to two operands; `_difference`: to x and the difference of two operands.
enum class Action : std::uint8_t {
    load,
    store,
    neg,
    abs,
    sqrt,
    add,
    sub,
    sub_back,
    mul,
    div,
    div_back,
    min,
    min_back,
    max,
    max_back,
    holds_gt,
    holds_gt_back,
    holds_ge,
    holds_ge_back,
    holds_eq,
    at_least,
    at_least_back,
    add_both,
    sub_both,
    mul_both,
    min_difference,
    max_difference,
};

struct Step {
    Action action{};
    bool checked = false; // remembers whether a value is NaN
    std::uint32_t operand = 0;
    std::uint32_t other = 0; // the second one
};

// Values in memory: of a column from `values` on, or the same ones for each strip.
struct Operand {
    const void* values = nullptr;
    std::size_t moves = 0; // all bits set or none
};

// What the steps of a chain work on.
struct Memory {
    std::span<const Step> steps;
    const Operand* operands;
    double* stored;     // what steps have stored
    std::size_t stride; // doubles from one stored strip to the next
};

// How many samples a strip has: those that strip.hpp does at once.
inline constexpr std::size_t strip_width = 32;

} // namespace rtamt::discrete
