// What the core costs, in nanoseconds a sample (the best of several runs):
//
//     core_bench
//
// Offline over 10^6 samples with windows from narrow to as long as the trace, the samples that
// finish() adds included; online one sample at a time. Functions of the C library also as a ratio
// to a loop that calls the function alone, both over blocks that stay in the cache.
#include "discrete/executor.hpp"
#include "programs.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>
#include <vector>

namespace {

using programs::Builder;
using rtamt::Opcode;
using rtamt::Program;
using rtamt::discrete::Executor;
using rtamt::discrete::Outcome;

// always[0,k](a + b >= -2)
Program always(std::int64_t k) {
    Builder builder;
    const auto a = builder.input();
    const auto b = builder.input();
    const auto sum = builder.pointwise(Opcode::add, a, b);
    const auto margin = builder.pointwise(Opcode::sub, sum, builder.constant(-2));
    builder.output(builder.unary(Opcode::slide_min, margin, k + 1, k));
    return builder.program();
}

// a until[0,k] b
Program until(std::int64_t k) {
    Builder builder;
    const auto a = builder.input();
    const auto b = builder.input();
    builder.output(builder.binary(Opcode::until, a, b, k + 1, k));
    return builder.program();
}

// historically[0,k](once[d,d](a >= 3) -> once[0,d](b >= 3)), seven instructions and two inputs
Program response(std::int64_t k, std::int64_t d) {
    Builder builder;
    const auto a = builder.input();
    const auto b = builder.input();
    const auto three = builder.constant(3);
    const auto request = builder.pointwise(Opcode::sub, a, three);
    const auto grant = builder.pointwise(Opcode::sub, b, three);
    const auto none = builder.pointwise(Opcode::neg, request);
    const auto before =
        builder.unary(Opcode::shift, none, d, 0, std::numeric_limits<double>::infinity());
    const auto once = builder.unary(Opcode::slide_max, grant, d + 1, 0);
    const auto implied = builder.pointwise(Opcode::max, before, once);
    builder.output(builder.unary(Opcode::slide_min, implied, k + 1, 0));
    return builder.program();
}

template <class Work>
double best_of(int runs, std::size_t samples, Work&& work) {
    double best = std::numeric_limits<double>::infinity();
    for (int run = 0; run < runs; ++run) {
        const auto start = std::chrono::steady_clock::now();
        work();
        const std::chrono::duration<double, std::nano> spent =
            std::chrono::steady_clock::now() - start;
        best = std::min(best, spent.count() / static_cast<double>(samples));
    }
    return best;
}

constexpr std::size_t trace = 1'000'000;

struct Trace {
    std::vector<double> a;
    std::vector<double> b;

    Trace() {
        std::mt19937 engine(1);
        std::normal_distribution<double> normal;
        for (std::size_t i = 0; i < trace; ++i) {
            a.push_back(normal(engine));
            b.push_back(normal(engine));
        }
    }
};

void offline(const char* name, const Program& program, const Trace& samples) {
    const std::vector<const double*> columns{samples.a.data(), samples.b.data()};
    std::vector<double> result(trace);
    const std::vector<double*> outputs{result.data()};
    const double cost = best_of(5, trace, [&] {
        if (Executor::evaluate(program, columns, trace, outputs)) std::puts("undefined");
    });
    std::printf("offline %-34s %6.2f ns a sample\n", name, cost);
}

void online(const char* name, const Program& program, const Trace& samples) {
    Executor executor(program);
    double total = 0;
    const double cost = best_of(5, trace, [&] {
        for (std::size_t i = 0; i < trace; ++i) {
            const double row[] = {samples.a[i], samples.b[i]};
            double value = 0;
            if (executor.step(row, value) == Outcome::known) total += value;
        }
    });
    std::printf("online  %-34s %6.2f ns a sample (%g)\n", name, cost, total > 0 ? 1.0 : 0.0);
}

// A function of one operand, or of two, which `alone` computes in a plain loop.
template <class Alone>
void libm(const char* name, Opcode opcode, bool binary, const Trace& samples, Alone&& alone) {
    Builder builder;
    const auto a = builder.input();
    const auto b = builder.input();
    builder.output(binary ? builder.pointwise(opcode, a, b) : builder.pointwise(opcode, a));
    const Program program = builder.program();
    const std::vector<const double*> columns{samples.a.data(), samples.b.data()};
    std::vector<double> result(trace);
    const std::vector<double*> outputs{result.data()};
    double here = std::numeric_limits<double>::infinity();
    double there = here;
    for (int run = 0; run < 15; ++run) { // by turns, so that a busy machine delays both
        here = std::min(here, best_of(1, trace, [&] {
                            if (Executor::evaluate(program, columns, trace, outputs)) {
                                std::puts("undefined");
                            }
                        }));
        there = std::min(there, best_of(1, trace, [&] {
                             for (std::size_t i = 0; i < trace; ++i)
                                 result[i] = alone(samples.a[i], samples.b[i]);
                         }));
    }
    std::printf("offline %-34s %6.2f ns a sample, %.2f times the function alone\n", name, here,
                here / there);
}

} // namespace

int main() {
    const Trace samples;
    for (const std::int64_t k : {0, 1, 3, 10, 100, 1000, 100000, 1000000}) {
        offline(("always[0," + std::to_string(k) + "](a+b>=-2)").c_str(), always(k), samples);
    }
    for (const std::int64_t k : {1, 10, 100, 1000, 100000, 1000000}) {
        offline(("a until[0," + std::to_string(k) + "] b").c_str(), until(k), samples);
    }
    offline("response, windows of 100 and 5", response(100, 5), samples);
    libm("sin(a)", Opcode::sin, false, samples, [](double a, double) { return std::sin(a); });
    libm("cos(a)", Opcode::cos, false, samples, [](double a, double) { return std::cos(a); });
    libm("exp(a)", Opcode::exp, false, samples, [](double a, double) { return std::exp(a); });
    libm("atan2(a, b)", Opcode::atan2, true, samples,
         [](double a, double b) { return std::atan2(a, b); });
    libm("hypot(a, b)", Opcode::hypot, true, samples,
         [](double a, double b) { return std::hypot(a, b); });
    online("always[0,10](a+b>=-2)", always(10), samples);
    online("response, windows of 100 and 5", response(100, 5), samples);
    online("response, windows of 10^6", response(1000000, 1000000), samples);
    return 0;
}
