#include "discrete/pointwise.hpp"

#include "programs.hpp"
#include "values/functions.hpp"
#include "ways.hpp"

#include <cmath>
#include <utility>

using oracle::inf;
using programs::Builder;
using rtamt::Opcode;
using ways::Executor;
using ways::Random;
using ways::Signal;

static const std::vector<Opcode> unary{
    Opcode::neg,     Opcode::abs,     Opcode::sqrt,  Opcode::exp,  Opcode::ln,    Opcode::sin,
    Opcode::cos,     Opcode::tan,     Opcode::atan,  Opcode::sinh, Opcode::cosh,  Opcode::tanh,
    Opcode::degrees, Opcode::radians, Opcode::floor, Opcode::ceil, Opcode::round, Opcode::sign};
static const std::vector<Opcode> binary{
    Opcode::add,      Opcode::sub,   Opcode::mul,   Opcode::div,      Opcode::pow,
    Opcode::log,      Opcode::min,   Opcode::max,   Opcode::holds_gt, Opcode::holds_ge,
    Opcode::holds_eq, Opcode::atan2, Opcode::hypot, Opcode::mod};

// Above 1, where no operation makes NaN.
static Signal tame(Random& random, std::size_t count) {
    Signal signal;
    for (std::size_t i = 0; i < count; ++i) {
        signal.push_back(1.25 + static_cast<double>(random.between(0, 12)) / 4);
    }
    return signal;
}

TEST_CASE("every operation is its definition at every lag and in any chunks") {
    Random random(3);
    for (const std::size_t count : std::initializer_list<std::size_t>{0, 1, 3, 700}) {
        const std::vector<Signal> columns{tame(random, count), tame(random, count)};
        for (const std::int64_t lag : {0, 1, 5, 300}) {
            Builder builder;
            const auto a = builder.input();
            const auto b = builder.input();
            const auto c = builder.constant(2.5);
            const auto late_a = builder.later(a, lag);
            const auto late_b = builder.later(b, lag);
            for (const Opcode opcode : unary)
                builder.output(builder.pointwise(opcode, late_a));
            for (const Opcode opcode : binary) {
                builder.output(builder.pointwise(opcode, late_a, late_b));
                builder.output(builder.pointwise(opcode, late_a, c));
                builder.output(builder.pointwise(opcode, c, late_b));
                builder.output(builder.pointwise(opcode, late_a, late_a));
                builder.output(builder.pointwise(opcode, c, c));
            }
            ways::check_all_ways(builder.program(), columns, count, random,
                                 "lag " + std::to_string(lag));
        }
    }
}

TEST_CASE("comparisons differ at equality only") {
    Builder builder;
    const auto a = builder.input();
    const auto zero = builder.constant(0.0);
    for (const Opcode opcode : {Opcode::holds_gt, Opcode::holds_ge, Opcode::holds_eq}) {
        builder.output(builder.pointwise(opcode, a, zero));
    }
    std::vector<Signal> outputs;
    CHECK(!ways::offline(builder.program(), {{-1.0, -0.0, 0.0, 1.0}}, 4, outputs));
    CHECK((outputs[0] == Signal{-inf, -inf, -inf, inf}));
    CHECK((outputs[1] == Signal{-inf, inf, inf, inf}));
    CHECK((outputs[2] == Signal{-inf, inf, inf, -inf}));
}

TEST_CASE("dividing by a zero of either sign is the same however the zero came about") {
    const std::vector<Signal> columns{{0.0, -0.0, 0.0, -0.0, -1.0}, {-0.0, 0.0, 0.0, -0.0, 0.0}};
    for (const bool swapped : {false, true}) {
        Builder builder;
        const auto a = builder.input();
        const auto b = builder.input();
        const auto one = builder.constant(1.0);
        for (const Opcode opcode : {Opcode::min, Opcode::max}) {
            const auto chosen = builder.pointwise(opcode, swapped ? b : a, swapped ? a : b);
            builder.output(builder.pointwise(Opcode::div, one, chosen));
        }
        std::vector<Signal> outputs;
        CHECK(!ways::offline(builder.program(), columns, 5, outputs));
        CHECK((outputs[0] == Signal{inf, inf, inf, inf, -1.0}));
        CHECK((outputs[1] == Signal{inf, inf, inf, inf, inf}));
    }
}

TEST_CASE("every partial operation reports the sample where it makes nan") {
    struct Case {
        Opcode opcode;
        double a;
        double b;
    };
    for (const Case& example :
         {Case{Opcode::sqrt, -1, 0}, Case{Opcode::ln, -1, 0}, Case{Opcode::add, inf, -inf},
          Case{Opcode::sub, inf, inf}, Case{Opcode::mul, 0, inf}, Case{Opcode::div, 0, 0},
          Case{Opcode::pow, -1, 0.5}, Case{Opcode::log, -1, 2}, Case{Opcode::sin, inf, 0},
          Case{Opcode::cos, -inf, 0}, Case{Opcode::tan, inf, 0}, Case{Opcode::asin, 1.5, 0},
          Case{Opcode::acos, -2, 0}, Case{Opcode::mod, 1, 0}, Case{Opcode::mod, inf, 2},
          Case{Opcode::at_least, 1, 2}}) {
        const bool two = rtamt::info(example.opcode).operands == 2;
        for (const std::size_t bad : std::initializer_list<std::size_t>{0, 5, 299, 599}) {
            Builder builder;
            const auto a = builder.input();
            const auto b = builder.input();
            builder.output(builder.pointwise(example.opcode, a, two ? b : rtamt::no_operand));
            std::vector<Signal> columns{Signal(600, 0.5), Signal(600, 0.25)};
            columns[0][bad] = example.a;
            columns[1][bad] = example.b;
            std::vector<Signal> outputs;
            const auto failure = ways::offline(builder.program(), columns, 600, outputs);
            const std::string name(rtamt::info(example.opcode).name);
            CHECK_MESSAGE(
                (failure && failure->instruction == 2 && std::cmp_equal(failure->sample, bad)),
                name);
            Executor executor(builder.program());
            const auto online = ways::push(executor, columns, 0, 600, outputs);
            CHECK_MESSAGE(
                (online && online->instruction == 2 && std::cmp_equal(online->sample, bad)), name);
        }
    }
}

TEST_CASE("infinite values are legal") {
    Builder builder;
    const auto a = builder.input();
    builder.output(builder.pointwise(Opcode::add, a, a));
    builder.output(builder.pointwise(Opcode::exp, a));
    std::vector<Signal> outputs;
    CHECK(!ways::offline(builder.program(), {{inf, -inf}}, 2, outputs));
    CHECK((outputs[0] == Signal{inf, -inf}));
    CHECK((outputs[1] == Signal{inf, 0.0}));
}

// Of a sample and a constant, in either order.
template <class Function>
static bool makes_nan(double constant, bool first) {
    bool seen = false;
    for (const double sample : {-inf, -1e308, -2.0, -0.0, 0.0, 0.5, 1e308, inf}) {
        seen |= std::isnan(first ? Function::of(constant, sample) : Function::of(sample, constant));
    }
    return seen;
}

TEST_CASE("an operation with a constant can fail if some sample makes nan") {
    namespace functions = rtamt::functions;
    struct Case {
        Opcode opcode;
        bool (*makes_nan)(double, bool);
    };
    for (const Case& example : {Case{Opcode::add, makes_nan<functions::Add>},
                                Case{Opcode::sub, makes_nan<functions::Sub>},
                                Case{Opcode::mul, makes_nan<functions::Mul>},
                                Case{Opcode::div, makes_nan<functions::Div>}}) {
        for (const double constant : {-inf, -1e308, -3.0, -0.0, 0.0, 5e-324, 3.0, 1e308, inf}) {
            for (const bool first : {true, false}) {
                Builder builder;
                const auto a = builder.input();
                const auto c = builder.constant(constant);
                builder.output(builder.pointwise(example.opcode, first ? c : a, first ? a : c));
                const auto& program = builder.program();
                CHECK(program.can_fail(program.instructions.back()) ==
                      example.makes_nan(constant, first));
            }
        }
    }
}
