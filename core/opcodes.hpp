// Every instruction of a program: code (its place in the list), name, operands and what it needs.
//
// The order is part of the program format: new opcodes go to the end. A call runs a kernel that is
// not of the core (rtamt/kernel.hpp); its operands are listed beside the program.
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
};

// What the number n of an instruction means.
enum class Count : std::uint8_t { none, input, distance, width, call };

struct OpcodeInfo {
    std::string_view name;
    std::uint8_t operands;
    bool pointwise; // a function of the operands at the same instant, without state
    bool partial;   // may turn numbers into NaN
    Count count;
};

inline constexpr std::array<OpcodeInfo, 26> opcodes{{
    {"input", 0, false, false, Count::input},     {"const", 0, false, false, Count::none},
    {"neg", 1, true, false, Count::none},         {"abs", 1, true, false, Count::none},
    {"sqrt", 1, true, true, Count::none},         {"exp", 1, true, false, Count::none},
    {"ln", 1, true, true, Count::none},           {"add", 2, true, true, Count::none},
    {"sub", 2, true, true, Count::none},          {"mul", 2, true, true, Count::none},
    {"div", 2, true, true, Count::none},          {"pow", 2, true, true, Count::none},
    {"log", 2, true, true, Count::none},          {"min", 2, true, false, Count::none},
    {"max", 2, true, false, Count::none},         {"holds_gt", 2, true, false, Count::none},
    {"holds_ge", 2, true, false, Count::none},    {"holds_eq", 2, true, false, Count::none},
    {"shift", 1, false, false, Count::distance},  {"slide_max", 1, false, false, Count::width},
    {"slide_min", 1, false, false, Count::width}, {"run_max", 1, false, false, Count::none},
    {"run_min", 1, false, false, Count::none},    {"since", 2, false, false, Count::none},
    {"until", 2, false, false, Count::width},     {"call", 0, false, true, Count::call},
}};

static_assert(opcodes[static_cast<std::size_t>(Opcode::call)].name == "call");

[[nodiscard]] constexpr const OpcodeInfo& info(Opcode opcode) noexcept {
    return opcodes[static_cast<std::size_t>(opcode)];
}

} // namespace rtamt
