// What the dense core costs, in nanoseconds an event of the input (the best of several runs):
//
//     dense_bench
//
// Offline over 10^6 events an input, the two inputs not synchronised, a second apart on average in
// ticks of a nanosecond; online one event an update; and 10^7 events beside 10^6.
#include "dense/executor.hpp"
#include "programs.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace {

using programs::Builder;
using rtamt::Opcode;
using rtamt::Program;
using rtamt::dense::EventList;
using rtamt::dense::Events;
using rtamt::dense::Executor;

constexpr std::int64_t second = 1'000'000'000;

std::uint32_t at_least(Builder& builder, double limit) {
    return builder.pointwise(Opcode::sub, builder.input(), builder.constant(limit));
}

// a >= 0.5
Program predicate() {
    Builder builder;
    builder.output(at_least(builder, 0.5));
    return builder.program();
}

// always[0,k](a >= 0.5), or once[0,k](a >= 0.5)
Program window(Opcode opcode, std::int64_t k, bool future) {
    Builder builder;
    const std::int64_t width = k * second;
    builder.output(builder.unary(opcode, at_least(builder, 0.5), width, future ? width : 0));
    return builder.program();
}

// (a >= 0.5) since[0,k] (b >= 0.5)
Program since(std::int64_t k) {
    Builder builder;
    const auto phi = at_least(builder, 0.5);
    const auto psi = at_least(builder, 0.5);
    builder.output(builder.pointwise(Opcode::min, builder.binary(Opcode::since, phi, psi, 0, 0),
                                     builder.unary(Opcode::slide_max, psi, k * second, 0)));
    return builder.program();
}

// (a >= 0.5) until[0,k] (b >= 0.5)
Program until(std::int64_t k) {
    Builder builder;
    const auto phi = at_least(builder, 0.5);
    const auto psi = at_least(builder, 0.5);
    builder.output(builder.binary(Opcode::until, phi, psi, k * second, k * second));
    return builder.program();
}

struct Trace {
    std::vector<std::int64_t> times[2];
    std::vector<double> values[2];

    explicit Trace(std::size_t count) {
        std::mt19937_64 engine(1);
        std::normal_distribution<double> normal;
        std::uniform_int_distribution<std::int64_t> gap(1, 2 * second);
        for (std::size_t input = 0; input < 2; ++input) {
            std::int64_t time = 1'700'000'000 * second;
            for (std::size_t i = 0; i < count; ++i) {
                times[input].push_back(time += gap(engine));
                values[input].push_back(normal(engine));
            }
        }
    }

    [[nodiscard]] std::vector<Events> events(std::size_t inputs, std::size_t begin,
                                             std::size_t count) const {
        std::vector<Events> events;
        events.reserve(inputs);
        for (std::size_t input = 0; input < inputs; ++input)
            events.push_back({times[input].data() + begin, values[input].data() + begin, count});
        return events;
    }
};

template <class Work>
double best_of(int runs, std::size_t events, Work&& work) {
    double best = std::numeric_limits<double>::infinity();
    for (int run = 0; run < runs; ++run) {
        const auto start = std::chrono::steady_clock::now();
        work();
        const std::chrono::duration<double, std::nano> spent =
            std::chrono::steady_clock::now() - start;
        best = std::min(best, spent.count() / static_cast<double>(events));
    }
    return best;
}

void evaluate(const Program& program, const std::vector<Events>& inputs, EventList& result) {
    std::vector<EventList> outputs(1);
    if (Executor::evaluate(program, inputs, 0, outputs)) std::puts("undefined");
    std::swap(result, outputs[0]);
}

double offline(const Program& program, const Trace& trace) {
    const std::size_t count = trace.times[0].size();
    const auto inputs = trace.events(program.inputs, 0, count);
    return best_of(5, count * program.inputs, [&] {
        EventList result;
        evaluate(program, inputs, result);
    });
}

// How many times as much a trace costs as a tenth of it: its ten parts one by one, results kept, so
// that both touch the same memory for the first time.
double growth(const Program& program, const Trace& trace) {
    const std::size_t count = trace.times[0].size();
    const double parts = best_of(2, 1, [&] {
        std::vector<EventList> results(10);
        for (std::size_t part = 0; part < 10; ++part) {
            evaluate(program, trace.events(program.inputs, part * count / 10, count / 10),
                     results[part]);
        }
    });
    const double whole = best_of(2, 1, [&] {
        EventList result;
        evaluate(program, trace.events(program.inputs, 0, count), result);
    });
    return 10 * whole / parts;
}

double online(const Program& program, const Trace& trace) {
    const std::size_t count = trace.times[0].size();
    return best_of(3, count * program.inputs, [&] {
        Executor executor(program);
        std::vector<EventList> outputs(1);
        std::vector<Events> inputs(program.inputs);
        std::size_t next[2] = {0, 0};
        while (next[0] < count && next[1] < count) { // in the order of time
            const std::size_t input =
                program.inputs == 2 && trace.times[1][next[1]] < trace.times[0][next[0]] ? 1 : 0;
            inputs.assign(program.inputs, {});
            inputs[input] = {&trace.times[input][next[input]], &trace.values[input][next[input]],
                             1};
            ++next[input];
            outputs[0].resize(0);
            if (executor.push(inputs, outputs)) std::puts("undefined");
        }
    });
}

void report(const std::string& name, const Program& program, const Trace& trace,
            const Trace& longer) {
    std::printf("%-18s offline %6.2f ns an event, 10^7 events %5.2f times as much, online %6.1f\n",
                name.c_str(), offline(program, trace), growth(program, longer),
                online(program, trace));
}

} // namespace

int main() {
    const Trace trace(1'000'000);
    const Trace longer(10'000'000);
    report("a >= 0.5", predicate(), trace, longer);
    for (const std::int64_t k : {5, 100, 10000, 100000}) {
        const std::string bounds = "[0," + std::to_string(k) + "]";
        report("always" + bounds, window(Opcode::slide_min, k, true), trace, longer);
        report("once" + bounds, window(Opcode::slide_max, k, false), trace, longer);
        report("since" + bounds, since(k), trace, longer);
        report("until" + bounds, until(k), trace, longer);
    }
    return 0;
}
