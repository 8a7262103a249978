// What each value domain costs, in nanoseconds a slot and a trace (the best of several runs):
//
//     domain_bench
//
// Offline over 10^5 slots in discrete time. `one lane` runs the loops that serve every domain on
// the values that the unrolled ones of `real` run on.
#include "discrete/executor.hpp"
#include "discrete/kernels.hpp"
#include "discrete/two_stack.hpp"
#include "discrete/window.hpp"
#include "programs.hpp"
#include "values/interval.hpp"
#include "values/lanes.hpp"
#include "values/real.hpp"
#include "values/truth.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <random>
#include <vector>

namespace {

using programs::Builder;
using rtamt::Opcode;
using rtamt::Program;
using rtamt::discrete::BasicExecutor;

constexpr std::size_t slots = 100'000;

Program window(std::int64_t k) {
    Builder builder;
    builder.output(builder.unary(Opcode::slide_max, builder.input(), k + 1, k));
    return builder.program();
}

Program until(std::int64_t k) {
    Builder builder;
    const auto a = builder.input();
    const auto b = builder.input();
    builder.output(builder.binary(Opcode::until, a, b, k + 1, k));
    return builder.program();
}

Program since() {
    Builder builder;
    const auto a = builder.input();
    const auto b = builder.input();
    builder.output(builder.binary(Opcode::since, a, b, 0, 0));
    return builder.program();
}

// always[0,k](a >= 0.5 -> eventually[0,5](b >= 0.5)), predicates included
Program response(std::int64_t k) {
    Builder builder;
    const auto limit = builder.constant(0.5);
    const auto a = builder.pointwise(Opcode::holds_ge, builder.input(), limit);
    const auto b = builder.pointwise(Opcode::holds_ge, builder.input(), limit);
    const auto soon = builder.unary(Opcode::slide_max, b, 6, 5);
    const auto none = builder.later(builder.pointwise(Opcode::neg, a), 5);
    const auto implied = builder.pointwise(Opcode::max, none, soon);
    builder.output(builder.unary(Opcode::slide_min, implied, k + 1, k + 5));
    return builder.program();
}

double normal(std::mt19937_64& engine) {
    return std::normal_distribution<double>()(engine);
}

template <class Value>
Value random_value(std::mt19937_64& engine) {
    Value value{};
    if constexpr (std::is_same_v<Value, std::uint64_t>) {
        value = engine();
    } else if constexpr (std::is_same_v<Value, double>) {
        value = normal(engine);
    } else if constexpr (std::is_same_v<Value, rtamt::Bounds>) {
        value.lower = normal(engine);
        value.upper = value.lower + 0.5;
    } else {
        for (double& lane : value.lane)
            lane = normal(engine);
    }
    return value;
}

template <class D>
double cost(const Program& program, std::size_t traces) {
    using Number = typename D::Number::Value;
    std::mt19937_64 engine(1);
    std::vector<std::vector<Number>> numbers(2);
    std::vector<std::vector<typename D::Value>> formulas(2);
    std::vector<typename BasicExecutor<D>::Column> columns;
    const BasicExecutor<D> executor(program);
    for (std::size_t input = 0; input < program.inputs; ++input) {
        const bool number =
            rtamt::UniformDomain<D> || executor.input_sort(input) == rtamt::Sort::number;
        for (std::size_t i = 0; i < slots; ++i) {
            if (number) {
                numbers[input].push_back(random_value<Number>(engine));
            } else {
                formulas[input].push_back(random_value<typename D::Value>(engine));
            }
        }
        if constexpr (rtamt::UniformDomain<D>) {
            columns.push_back(numbers[input].data());
        } else {
            columns.push_back(number ? static_cast<const void*>(numbers[input].data())
                                     : formulas[input].data());
        }
    }
    std::vector<typename D::Value> result(slots);
    const std::vector<typename D::Value*> outputs{result.data()};
    double best = std::numeric_limits<double>::infinity();
    for (int run = 0; run < 9; ++run) {
        const auto start = std::chrono::steady_clock::now();
        if (BasicExecutor<D>::evaluate(program, columns, slots, outputs)) std::puts("undefined");
        const std::chrono::duration<double, std::nano> spent =
            std::chrono::steady_clock::now() - start;
        best = std::min(best, spent.count() / static_cast<double>(slots));
    }
    return best / static_cast<double>(traces);
}

// The window's loops alone, unrolled or not.
template <class D>
double loops(std::size_t width) {
    using Window = rtamt::discrete::TwoStack<rtamt::Joined<rtamt::MaxOf<D>>>;
    std::mt19937_64 engine(1);
    std::vector<typename D::Value> ring(width);
    std::vector<typename D::Value> in(256);
    std::vector<typename D::Value> out(256);
    for (auto& value : in)
        value = random_value<typename D::Value>(engine);
    double best = std::numeric_limits<double>::infinity();
    for (int run = 0; run < 9; ++run) {
        Window stack(width, ring.data(), nullptr);
        const auto start = std::chrono::steady_clock::now();
        for (int block = 0; block < 2000; ++block)
            stack.push({in.data(), nullptr}, out.data(), in.size());
        const std::chrono::duration<double, std::nano> spent =
            std::chrono::steady_clock::now() - start;
        best = std::min(best, spent.count() / (2000.0 * 256));
    }
    return best;
}

void row(const char* name, const Program& program) {
    std::printf("%-30s real %6.2f  interval %6.2f  8 lanes %6.3f  64 truths %7.4f\n", name,
                cost<rtamt::Real>(program, 1), cost<rtamt::Interval>(program, 1),
                cost<rtamt::Lanes<8>>(program, 8), cost<rtamt::Truth>(program, 64));
}

} // namespace

int main() {
    row("once, 10 slots", window(10));
    row("once, 1000 slots", window(1000));
    row("until, 10 slots", until(10));
    row("until, 1000 slots", until(1000));
    row("since", since());
    row("response of two predicates", response(100));
    for (const std::size_t width : {10U, 100U, 1000U}) {
        std::printf("window loops, width %-5zu real %6.2f  one lane %6.2f\n", width,
                    loops<rtamt::Real>(width), loops<rtamt::Lanes<1>>(width));
    }
    return 0;
}
