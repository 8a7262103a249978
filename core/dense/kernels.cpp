#include "kernels.hpp"

#include "pointwise.hpp"
#include "running.hpp"
#include "shift.hpp"
#include "since.hpp"
#include "until.hpp"
#include "window.hpp"

namespace rtamt::dense {

std::unique_ptr<Kernel> make_kernel(const Instruction& instruction) {
    using namespace pointwise;
    const std::int64_t lag = instruction.lag;
    const std::int64_t n = instruction.n;
    switch (instruction.opcode) {
    case Opcode::input:
    case Opcode::constant:
    case Opcode::call: // made by the executor, which knows the program
        return nullptr;
    case Opcode::neg:
        return std::make_unique<Unary<Neg>>(lag);
    case Opcode::abs:
        return std::make_unique<Unary<Abs>>(lag);
    case Opcode::sqrt:
        return std::make_unique<Unary<Sqrt>>(lag);
    case Opcode::exp:
        return std::make_unique<Unary<Exp>>(lag);
    case Opcode::ln:
        return std::make_unique<Unary<Ln>>(lag);
    case Opcode::add:
        return std::make_unique<Binary<Add>>(lag);
    case Opcode::sub:
        return std::make_unique<Binary<Sub>>(lag);
    case Opcode::mul:
        return std::make_unique<Binary<Mul>>(lag);
    case Opcode::div:
        return std::make_unique<Binary<Div>>(lag);
    case Opcode::pow:
        return std::make_unique<Binary<Pow>>(lag);
    case Opcode::log:
        return std::make_unique<Binary<Log>>(lag);
    case Opcode::min:
        return std::make_unique<Binary<Join<Min>>>(lag);
    case Opcode::max:
        return std::make_unique<Binary<Join<Max>>>(lag);
    case Opcode::holds_gt:
        return std::make_unique<Binary<HoldsGreater>>(lag);
    case Opcode::holds_ge:
        return std::make_unique<Binary<HoldsGreaterEqual>>(lag);
    case Opcode::holds_eq:
        return std::make_unique<Binary<HoldsEqual>>(lag);
    case Opcode::shift:
        return std::make_unique<Shift>(lag, n, instruction.x);
    case Opcode::slide_max:
        return std::make_unique<Slide<Max>>(lag, n);
    case Opcode::slide_min:
        return std::make_unique<Slide<Min>>(lag, n);
    case Opcode::run_max:
        return std::make_unique<Running<Max>>(lag);
    case Opcode::run_min:
        return std::make_unique<Running<Min>>(lag);
    case Opcode::since:
        return std::make_unique<Since>(lag);
    case Opcode::until:
        return std::make_unique<Until>(lag, n);
    }
    return nullptr; // unreachable: parse() lets no other opcode through
}

} // namespace rtamt::dense
