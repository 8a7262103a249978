// Every instruction of a program: code (its place in the list), name, operands and what it needs.
//
// The order is part of the program format: new opcodes go to the end. A call runs a kernel that is
// not of the core (rtamt/kernel.hpp); its operands are listed next to the program.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace rtamt {

enum class Opcode : std::uint8_t {
    input,
    constant,
    neg,
    abs,
    sqrt,
    exp,
    ln,
    add,
    sub,
    mul,
    div,
    pow,
    log,
    min,
    max,
    holds_gt,
    holds_ge,
    holds_eq,
    shift,
    slide_max,
    slide_min,
    run_max,
    run_min,
    since,
    until,
    call,
    sin,
    cos,
    tan,
    asin,
    acos,
    atan,
    atan2,
    hypot,
    sinh,
    cosh,
    tanh,
    degrees,
    radians,
    floor,
    ceil,
    round,
    sign,
    mod,
    at_least,
    slide_sum,
    run_sum,
    rank_max,
    rank_min,
};

// What the number n of an instruction means. Of a rank it is a width, and x is the rank.
enum class Count : std::uint8_t { none, input, distance, width, rank, call };

// What an instruction works on. `either`: on numbers or on formulas, and it gives what it takes.
enum class Sort : std::uint8_t { number, formula, either };

struct OpcodeInfo {
    std::string_view name;
    std::uint8_t operands;
    bool pointwise; // a function of the operands at the same instant, without state
    bool partial;   // may turn numbers into NaN
    Count count;
    Sort takes;
    Sort gives;
};

inline constexpr std::array<OpcodeInfo, 49> opcodes{{
    {"input", 0, false, false, Count::input, Sort::either, Sort::either},
    {"const", 0, false, false, Count::none, Sort::either, Sort::either},
    {"neg", 1, true, false, Count::none, Sort::either, Sort::either},
    {"abs", 1, true, false, Count::none, Sort::number, Sort::number},
    {"sqrt", 1, true, true, Count::none, Sort::number, Sort::number},
    {"exp", 1, true, false, Count::none, Sort::number, Sort::number},
    {"ln", 1, true, true, Count::none, Sort::number, Sort::number},
    {"add", 2, true, true, Count::none, Sort::number, Sort::number},
    {"sub", 2, true, true, Count::none, Sort::number, Sort::number},
    {"mul", 2, true, true, Count::none, Sort::number, Sort::number},
    {"div", 2, true, true, Count::none, Sort::number, Sort::number},
    {"pow", 2, true, true, Count::none, Sort::number, Sort::number},
    {"log", 2, true, true, Count::none, Sort::number, Sort::number},
    {"min", 2, true, false, Count::none, Sort::either, Sort::either},
    {"max", 2, true, false, Count::none, Sort::either, Sort::either},
    {"holds_gt", 2, true, false, Count::none, Sort::number, Sort::formula},
    {"holds_ge", 2, true, false, Count::none, Sort::number, Sort::formula},
    {"holds_eq", 2, true, false, Count::none, Sort::number, Sort::formula},
    {"shift", 1, false, false, Count::distance, Sort::either, Sort::either},
    {"slide_max", 1, false, false, Count::width, Sort::either, Sort::either},
    {"slide_min", 1, false, false, Count::width, Sort::either, Sort::either},
    {"run_max", 1, false, false, Count::none, Sort::either, Sort::either},
    {"run_min", 1, false, false, Count::none, Sort::either, Sort::either},
    {"since", 2, false, false, Count::none, Sort::formula, Sort::formula},
    {"until", 2, false, false, Count::width, Sort::formula, Sort::formula},
    {"call", 0, false, true, Count::call, Sort::number, Sort::number},
    {"sin", 1, true, true, Count::none, Sort::number, Sort::number},
    {"cos", 1, true, true, Count::none, Sort::number, Sort::number},
    {"tan", 1, true, true, Count::none, Sort::number, Sort::number},
    {"asin", 1, true, true, Count::none, Sort::number, Sort::number},
    {"acos", 1, true, true, Count::none, Sort::number, Sort::number},
    {"atan", 1, true, false, Count::none, Sort::number, Sort::number},
    {"atan2", 2, true, false, Count::none, Sort::number, Sort::number},
    {"hypot", 2, true, false, Count::none, Sort::number, Sort::number},
    {"sinh", 1, true, false, Count::none, Sort::number, Sort::number},
    {"cosh", 1, true, false, Count::none, Sort::number, Sort::number},
    {"tanh", 1, true, false, Count::none, Sort::number, Sort::number},
    {"degrees", 1, true, false, Count::none, Sort::number, Sort::number},
    {"radians", 1, true, false, Count::none, Sort::number, Sort::number},
    {"floor", 1, true, false, Count::none, Sort::number, Sort::number},
    {"ceil", 1, true, false, Count::none, Sort::number, Sort::number},
    {"round", 1, true, false, Count::none, Sort::number, Sort::number},
    {"sign", 1, true, false, Count::none, Sort::number, Sort::number},
    {"mod", 2, true, true, Count::none, Sort::number, Sort::number},
    {"at_least", 2, true, true, Count::none, Sort::number, Sort::number},
    {"slide_sum", 1, false, true, Count::width, Sort::number, Sort::number},
    {"run_sum", 1, false, true, Count::none, Sort::number, Sort::number},
    {"rank_max", 1, false, false, Count::rank, Sort::formula, Sort::formula},
    {"rank_min", 1, false, false, Count::rank, Sort::formula, Sort::formula},
}};

static_assert(opcodes[static_cast<std::size_t>(Opcode::call)].name == "call");
static_assert(opcodes[static_cast<std::size_t>(Opcode::rank_min)].name == "rank_min");

[[nodiscard]] constexpr const OpcodeInfo& info(Opcode opcode) noexcept {
    return opcodes[static_cast<std::size_t>(opcode)];
}

} // namespace rtamt
