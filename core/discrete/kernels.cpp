#include "kernels.hpp"

#include "pointwise.hpp"
#include "running.hpp"
#include "shift.hpp"
#include "since.hpp"
#include "until.hpp"
#include "window.hpp"

namespace rtamt::discrete {

std::size_t state_size(const Instruction& instruction) noexcept {
    switch (instruction.opcode) {
    case Opcode::shift:
    case Opcode::slide_max:
    case Opcode::slide_min:
        return static_cast<std::size_t>(instruction.n);
    case Opcode::until:
        return 2 * static_cast<std::size_t>(instruction.n);
    default:
        return 0;
    }
}

std::unique_ptr<Kernel> make_kernel(const Instruction& instruction, std::int64_t operand_lag,
                                    double* state, double* journal, Same same) {
    using namespace pointwise;
    const auto n = static_cast<std::size_t>(instruction.n);
    switch (instruction.opcode) {
    case Opcode::input:
    case Opcode::constant:
    case Opcode::call: // made by the executor, which knows the program
        return nullptr;
    case Opcode::neg:
        return std::make_unique<Unary<Neg>>(operand_lag);
    case Opcode::abs:
        return std::make_unique<Unary<Abs>>(operand_lag);
    case Opcode::sqrt:
        return std::make_unique<Unary<Sqrt>>(operand_lag);
    case Opcode::exp:
        return std::make_unique<Unary<Exp>>(operand_lag);
    case Opcode::ln:
        return std::make_unique<Unary<Ln>>(operand_lag);
    case Opcode::add:
        return std::make_unique<Binary<Add>>(operand_lag, same);
    case Opcode::sub:
        return std::make_unique<Binary<Sub>>(operand_lag, same);
    case Opcode::mul:
        return std::make_unique<Binary<Mul>>(operand_lag, same);
    case Opcode::div:
        return std::make_unique<Binary<Div>>(operand_lag, same);
    case Opcode::pow:
        return std::make_unique<Binary<Pow>>(operand_lag, same);
    case Opcode::log:
        return std::make_unique<Binary<Log>>(operand_lag, same);
    case Opcode::min:
        return std::make_unique<Binary<Join<Min>>>(operand_lag, same);
    case Opcode::max:
        return std::make_unique<Binary<Join<Max>>>(operand_lag, same);
    case Opcode::holds_gt:
        return std::make_unique<Binary<HoldsGreater>>(operand_lag, same);
    case Opcode::holds_ge:
        return std::make_unique<Binary<HoldsGreaterEqual>>(operand_lag, same);
    case Opcode::holds_eq:
        return std::make_unique<Binary<HoldsEqual>>(operand_lag, same);
    case Opcode::shift:
        return std::make_unique<Shift>(operand_lag, n, instruction.x, state, journal);
    case Opcode::slide_max:
        return std::make_unique<Slide<Max>>(operand_lag, n, state, journal);
    case Opcode::slide_min:
        return std::make_unique<Slide<Min>>(operand_lag, n, state, journal);
    case Opcode::run_max:
        return std::make_unique<Running<Max>>(operand_lag);
    case Opcode::run_min:
        return std::make_unique<Running<Min>>(operand_lag);
    case Opcode::since:
        return std::make_unique<Since>(operand_lag);
    case Opcode::until:
        return std::make_unique<Until>(operand_lag, n, state, journal);
    }
    return nullptr; // unreachable: parse() lets no other opcode through
}

} // namespace rtamt::discrete
