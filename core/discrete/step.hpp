// The steps that a chain of operations on doubles consists of, and what they work on.
//
// Memory: sixteen bytes a step.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace rtamt::discrete {

// What a step does to the accumulator x and its operand y; `_back`: with both exchanged; `_both`:
// to two operands; `min_` and `max_`: to x and a term of two operands.
//
// The terms are the difference of two operands, and how far the sum or the difference of two
// columns lies over or under a limit. Where a term of a limit is joined to x, both are looked at
// for NaN.
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
    sum_over,
    min_sum_over,
    max_sum_over,
    sum_under,
    min_sum_under,
    max_sum_under,
    difference_over,
    min_difference_over,
    max_difference_over,
    difference_under,
    min_difference_under,
    max_difference_under,
};

struct Step {
    Action action{};
    bool checked = false; // remembers whether a value is NaN
    std::uint32_t operand = 0;
    std::uint32_t other = 0; // the second one
    std::uint32_t limit = 0; // a constant
};

// What the steps of a chain work on.
struct Memory {
    std::span<const Step> steps;
    // By operand: its values, and whether these are those of a column, of which the strip's begin
    // at its place (all bits set), or the same ones for each strip (none).
    const void* const* values;
    const std::size_t* moves;
    double* stored;     // what steps have stored
    std::size_t stride; // doubles from one stored strip to the next
};

// How many samples a strip has: those that strip.hpp does at once.
inline constexpr std::size_t strip_width = 32;

} // namespace rtamt::discrete
