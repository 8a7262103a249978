#include "program/opcodes.hpp"

#include "check.hpp"

#include <set>

using rtamt::Opcode;

TEST_CASE("codes are the ones of the program format") {
    CHECK(rtamt::opcodes.size() == 49);
    CHECK((rtamt::info(Opcode::input).name == "input" && static_cast<int>(Opcode::input) == 0));
    CHECK(
        (rtamt::info(Opcode::constant).name == "const" && static_cast<int>(Opcode::constant) == 1));
    CHECK((rtamt::info(Opcode::ln).name == "ln" && static_cast<int>(Opcode::ln) == 6));
    CHECK((rtamt::info(Opcode::log).name == "log" && static_cast<int>(Opcode::log) == 12));
    CHECK((rtamt::info(Opcode::holds_eq).name == "holds_eq" &&
           static_cast<int>(Opcode::holds_eq) == 17));
    CHECK((rtamt::info(Opcode::shift).name == "shift" && static_cast<int>(Opcode::shift) == 18));
    CHECK((rtamt::info(Opcode::run_min).name == "run_min" &&
           static_cast<int>(Opcode::run_min) == 22));
    CHECK((rtamt::info(Opcode::until).name == "until" && static_cast<int>(Opcode::until) == 24));
    CHECK((rtamt::info(Opcode::call).name == "call" && static_cast<int>(Opcode::call) == 25));
    CHECK((rtamt::info(Opcode::sin).name == "sin" && static_cast<int>(Opcode::sin) == 26));
    CHECK((rtamt::info(Opcode::at_least).name == "at_least" &&
           static_cast<int>(Opcode::at_least) == 44));
    CHECK((rtamt::info(Opcode::run_sum).name == "run_sum" &&
           static_cast<int>(Opcode::run_sum) == 46));
}

TEST_CASE("names are unique") {
    std::set<std::string_view> names;
    for (const auto& opcode : rtamt::opcodes)
        names.insert(opcode.name);
    CHECK(names.size() == rtamt::opcodes.size());
}

TEST_CASE("only pointwise operations sums and calls are partial") {
    for (const auto& opcode : rtamt::opcodes)
        CHECK((opcode.pointwise || opcode.name == "call" || opcode.name.ends_with("_sum") ||
               !opcode.partial));
}
