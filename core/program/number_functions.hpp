// The function of numbers that an opcode applies: the one list of them for every engine.
#pragma once

#include "../values/functions.hpp"
#include "opcodes.hpp"

#include <utility>

namespace rtamt {

// Returns visit(function) for the opcode of a function of numbers, and otherwise() for all others.
template <class Visit, class Otherwise>
[[nodiscard]] auto with_function(Opcode opcode, Visit&& visit, Otherwise&& otherwise) {
    switch (opcode) {
    case Opcode::abs:
        return visit(functions::Abs{});
    case Opcode::sqrt:
        return visit(functions::Sqrt{});
    case Opcode::exp:
        return visit(functions::Exp{});
    case Opcode::ln:
        return visit(functions::Ln{});
    case Opcode::add:
        return visit(functions::Add{});
    case Opcode::sub:
        return visit(functions::Sub{});
    case Opcode::mul:
        return visit(functions::Mul{});
    case Opcode::div:
        return visit(functions::Div{});
    case Opcode::pow:
        return visit(functions::Pow{});
    case Opcode::log:
        return visit(functions::Log{});
    case Opcode::sin:
        return visit(functions::Sin{});
    case Opcode::cos:
        return visit(functions::Cos{});
    case Opcode::tan:
        return visit(functions::Tan{});
    case Opcode::asin:
        return visit(functions::Asin{});
    case Opcode::acos:
        return visit(functions::Acos{});
    case Opcode::atan:
        return visit(functions::Atan{});
    case Opcode::atan2:
        return visit(functions::Atan2{});
    case Opcode::hypot:
        return visit(functions::Hypot{});
    case Opcode::sinh:
        return visit(functions::Sinh{});
    case Opcode::cosh:
        return visit(functions::Cosh{});
    case Opcode::tanh:
        return visit(functions::Tanh{});
    case Opcode::degrees:
        return visit(functions::Degrees{});
    case Opcode::radians:
        return visit(functions::Radians{});
    case Opcode::floor:
        return visit(functions::Floor{});
    case Opcode::ceil:
        return visit(functions::Ceil{});
    case Opcode::round:
        return visit(functions::Round{});
    case Opcode::sign:
        return visit(functions::Sign{});
    case Opcode::mod:
        return visit(functions::Mod{});
    case Opcode::at_least:
        return visit(functions::AtLeast{});
    default:
        return otherwise();
    }
}

} // namespace rtamt
