#include "graph.hpp"

#include "../program/number_functions.hpp"

#include <cmath>
#include <stdexcept>
#include <type_traits>

namespace rtamt::early {

namespace {

namespace f = functions;

template <class Function>
[[nodiscard]] double of(double a, double b) noexcept {
    if constexpr (requires { Function::of(a, b); }) {
        return Function::of(a, b);
    } else {
        return Function::of(a);
    }
}

template <class Function>
[[nodiscard]] Bounds of(const Bounds& a, const Bounds& b) noexcept {
    if constexpr (requires(double x) { Function::of(x, x); }) {
        return Interval::apply<Function>(a, b);
    } else {
        return Interval::apply<Function>(a);
    }
}

template <class Value>
using DomainOf = std::conditional_t<std::is_same_v<Value, double>, Real, Interval>;

template <class Value>
[[nodiscard]] Value apply(Opcode opcode, const Value& a, const Value& b) noexcept {
    const auto other = [&] {
        switch (opcode) {
        case Opcode::neg:
            return of<f::Neg>(a, b);
        case Opcode::min:
            return DomainOf<Value>::meet(a, b);
        case Opcode::max:
            return DomainOf<Value>::join(a, b);
        case Opcode::holds_gt:
            return of<f::HoldsGreater>(a, b);
        case Opcode::holds_ge:
            return of<f::HoldsGreaterEqual>(a, b);
        default:
            return of<f::HoldsEqual>(a, b);
        }
    };
    return with_function(
        opcode, [&]<class Function>(Function) { return of<Function>(a, b); }, other);
}

[[nodiscard]] bool undefined(double value) noexcept {
    return std::isnan(value);
}

[[nodiscard]] bool undefined(const Bounds& value) noexcept {
    return Interval::undefined(value);
}

[[nodiscard]] double constant(double x, double /*like*/) noexcept {
    return x;
}

[[nodiscard]] Bounds constant(double x, const Bounds& /*like*/) noexcept {
    return Interval::of(x);
}

template <class Value>
[[nodiscard]] Value value_of(const Step& step, std::span<const Value> inputs,
                             std::span<Value> results) noexcept {
    if (step.opcode == Opcode::input) return inputs[step.a];
    if (step.opcode == Opcode::constant) return constant(step.x, Value{});
    const Value& a = results[step.a];
    switch (step.opcode) { // what most predicates consist of, without a call
    case Opcode::sub:
        return of<f::Sub>(a, results[step.b]);
    case Opcode::neg:
        return of<f::Neg>(a, a);
    case Opcode::holds_gt:
        return of<f::HoldsGreater>(a, results[step.b]);
    case Opcode::holds_ge:
        return of<f::HoldsGreaterEqual>(a, results[step.b]);
    default:
        return apply(step.opcode, a, step.b == none ? a : results[step.b]);
    }
}

} // namespace

double compute(Opcode opcode, double a, double b) noexcept {
    return apply(opcode, a, b);
}

Bounds compute(Opcode opcode, const Bounds& a, const Bounds& b) noexcept {
    return apply(opcode, a, b);
}

template <class Value>
std::uint32_t run(std::span<const Step> steps, std::span<const Value> inputs,
                  std::span<Value> results) noexcept {
    for (std::size_t i = 0; i < steps.size(); ++i) {
        results[i] = value_of(steps[i], inputs, results);
        if (undefined(results[i])) return static_cast<std::uint32_t>(i);
    }
    return none;
}

template std::uint32_t run(std::span<const Step>, std::span<const double>,
                           std::span<double>) noexcept;
template std::uint32_t run(std::span<const Step>, std::span<const Bounds>,
                           std::span<Bounds>) noexcept;

Wrong enclose(std::span<const Step> steps, std::span<const Bounds> inputs,
              std::span<Bounds> results) noexcept {
    Wrong wrong;
    const auto exact = [&](std::uint32_t step) {
        return step == none || results[step].lower == results[step].upper;
    };
    for (std::size_t i = 0; i < steps.size(); ++i) {
        const auto step = static_cast<std::uint32_t>(i);
        results[i] = value_of(steps[i], inputs, results);
        if (!undefined(results[i])) continue;
        if (wrong.any == none) wrong.any = step;
        if (wrong.exact == none && exact(steps[i].a) && exact(steps[i].b)) wrong.exact = step;
        results[i] = bounds::anything;
    }
    return wrong;
}

void Graph::check() const {
    const auto require = [](bool holds) {
        if (!holds) throw std::invalid_argument("This is not a graph that an engine can run.");
    };
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const Node& node = nodes[i];
        const auto earlier = [&](std::uint32_t ref) { return ref / 2 < i; };
        const bool pair = node.kind == Kind::both || node.kind == Kind::either ||
                          node.kind == Kind::until || node.kind == Kind::since ||
                          node.kind == Kind::since_dense;
        const bool rank = node.kind == Kind::rank_least || node.kind == Kind::rank_greatest;
        require(!rank || (node.steps.size() == 1 && node.low > -forever && node.high < forever &&
                          node.steps.front().x >= 1.0 && node.steps.front().x <= 0x1p53));
        require(node.kind <= Kind::pulses && (node.kind != Kind::held || node.low == node.high));
        if (node.kind == Kind::atom || node.kind == Kind::map) require(!node.steps.empty());
        if (node.kind != Kind::atom) require(earlier(node.a));
        if (pair || (node.kind != Kind::atom && node.b != none)) require(earlier(node.b));
        require(node.low <= node.high && node.high > -forever && node.low < forever);
        require(node.low >= 0 || node.high <= 0);
        require(node.kind != Kind::pulses || node.high <= 0);
        if (node.kind == Kind::sum) {
            require(node.high <= 0 && node.steps.size() == 1 &&
                    (node.steps.front().opcode == Opcode::slide_sum ||
                     node.steps.front().opcode == Opcode::run_sum));
            continue;
        }
        for (std::size_t s = 0; s < node.steps.size(); ++s) {
            const Step& step = node.steps[s];
            require(step.opcode < static_cast<Opcode>(opcodes.size()) &&
                    (info(step.opcode).pointwise || step.opcode == Opcode::input ||
                     step.opcode == Opcode::constant));
            if (node.kind == Kind::map) {
                require(step.opcode != Opcode::input && step.opcode != Opcode::constant);
                continue;
            }
            if (step.opcode == Opcode::input) {
                require(step.a < inputs);
            } else if (step.opcode != Opcode::constant) { // a second operand is read if it is there
                const bool second = info(step.opcode).operands > 1 || step.b != none;
                require(step.a < s && (!second || step.b < s));
            }
        }
    }
}

namespace {

// Of an expression.
[[nodiscard]] bool is_truth(std::span<const Step> steps) {
    std::vector<bool> truths;
    for (const Step& step : steps) {
        switch (step.opcode) {
        case Opcode::holds_gt:
        case Opcode::holds_ge:
        case Opcode::holds_eq:
            truths.push_back(true);
            break;
        case Opcode::constant:
            truths.push_back(std::isinf(step.x));
            break;
        case Opcode::neg:
            truths.push_back(truths[step.a]);
            break;
        case Opcode::min:
        case Opcode::max:
            truths.push_back(truths[step.a] && truths[step.b]);
            break;
        default:
            truths.push_back(false);
        }
    }
    return truths.back();
}

} // namespace

std::vector<bool> Graph::truths() const {
    std::vector<bool> truths;
    for (const Node& node : nodes) {
        bool truth = node.kind == Kind::atom ? is_truth(node.steps)
                                             : node.kind != Kind::map && node.kind != Kind::sum;
        if (node.kind != Kind::atom) {
            for (const std::uint32_t ref : {node.a, node.b})
                truth = truth && (ref == none || truths[ref / 2]);
        }
        truths.push_back(truth);
    }
    return truths;
}

} // namespace rtamt::early
