#include "values/bounds.hpp"

#include "check.hpp"
#include "laws.hpp"

#include <cmath>

using oracle::inf;
using rtamt::Bounds;
using rtamt::Interval;

namespace {

// A number within bounds: an end, zero, a whole number, or anything between.
double within(oracle::Random& random, Bounds bounds) {
    if (bounds.lower == bounds.upper) return bounds.lower;
    const auto inside = [&](double x) { return x >= bounds.lower && x <= bounds.upper; };
    for (int i = 0; i < 20; ++i) {
        const double x = static_cast<double>(random.between(-90, 90)) / 8;
        if (random.chance(60) && inside(std::trunc(x))) return std::trunc(x);
        if (random.chance(60) && inside(x)) return x;
    }
    return random.chance(50) ? bounds.lower : bounds.upper;
}

std::string text(Bounds bounds) {
    return "[" + std::to_string(bounds.lower) + ", " + std::to_string(bounds.upper) + "]";
}

template <class Function>
void check_unary(const char* name) {
    oracle::Random random(6);
    for (int i = 0; i < 20000; ++i) {
        const Bounds a = laws::Sampler<Interval>::one(random);
        const double x = within(random, a);
        const double y = Function::of(x);
        const Bounds result = Interval::apply<Function>(a);
        if (std::isnan(y)) continue; // outside the domain: cut off
        CHECK_MESSAGE((result.lower <= y && y <= result.upper),
                      (std::string(name) + " of " + std::to_string(x) + " in " + text(a) + " is " +
                       std::to_string(y) + ", not in " + text(result)));
    }
}

template <class Function>
void check_binary(const char* name) {
    oracle::Random random(7);
    for (int i = 0; i < 40000; ++i) {
        const Bounds a = laws::Sampler<Interval>::one(random);
        const Bounds b = laws::Sampler<Interval>::one(random);
        const double x = within(random, a);
        const double y = within(random, b);
        const double z = Function::of(x, y);
        const Bounds result = Interval::apply<Function>(a, b);
        if (std::isnan(z)) continue;
        CHECK_MESSAGE((result.lower <= z && z <= result.upper),
                      (std::string(name) + " of " + std::to_string(x) + " in " + text(a) + " and " +
                       std::to_string(y) + " in " + text(b) + " is " + std::to_string(z) +
                       ", not in " + text(result)));
    }
}

} // namespace

TEST_CASE("every result is within the bounds") {
    using namespace rtamt::functions;
    check_unary<Neg>("neg");
    check_unary<Abs>("abs");
    check_unary<Sqrt>("sqrt");
    check_unary<Exp>("exp");
    check_unary<Ln>("ln");
    check_unary<Sin>("sin");
    check_unary<Cos>("cos");
    check_unary<Tan>("tan");
    check_unary<Asin>("asin");
    check_unary<Acos>("acos");
    check_unary<Atan>("atan");
    check_unary<Sinh>("sinh");
    check_unary<Cosh>("cosh");
    check_unary<Tanh>("tanh");
    check_unary<Degrees>("degrees");
    check_unary<Radians>("radians");
    check_unary<Floor>("floor");
    check_unary<Ceil>("ceil");
    check_unary<Round>("round");
    check_unary<Sign>("sign");
    check_binary<Atan2>("atan2");
    check_binary<Hypot>("hypot");
    check_binary<Mod>("mod");
    check_binary<AtLeast>("at_least");
    check_binary<Add>("add");
    check_binary<Sub>("sub");
    check_binary<Mul>("mul");
    check_binary<Div>("div");
    check_binary<Pow>("pow");
    check_binary<Log>("log");
    check_binary<HoldsGreater>("holds_gt");
    check_binary<HoldsGreaterEqual>("holds_ge");
    check_binary<HoldsEqual>("holds_eq");
}

TEST_CASE("bounds of arithmetic are attained") {
    using namespace rtamt::functions;
    CHECK((Interval::apply<Add>({1, 2}, {-3, 5}) == Bounds{-2, 7}));
    CHECK((Interval::apply<Sub>({1, 2}, {-3, 5}) == Bounds{-4, 5}));
    CHECK((Interval::apply<Mul>({-1, 2}, {-3, 5}) == Bounds{-6, 10}));
    CHECK((Interval::apply<Div>({-1, 2}, {2, 4}) == Bounds{-0.5, 1}));
    CHECK((Interval::apply<Abs>({-3, 2}) == Bounds{0, 3}));
    CHECK((Interval::apply<Sqrt>({-3, 4}) == Bounds{0, 2}));
    CHECK((Interval::apply<HoldsGreater>({1, 3}, {2, 2}) == Bounds{-inf, inf}));
    CHECK((Interval::apply<HoldsGreaterEqual>({2, 3}, {2, 2}) == Bounds{inf, inf}));
    CHECK((Interval::apply<HoldsEqual>({2, 3}, {4, 5}) == Bounds{-inf, -inf}));
}

TEST_CASE("corners without a value have the ends that the definition gives") {
    using namespace rtamt::functions;
    CHECK((Interval::apply<Sub>({1, inf}, {2, inf}) == Bounds{-inf, inf}));
    CHECK((Interval::apply<Mul>({0, 0}, {-inf, inf}) == Bounds{0, 0}));
    CHECK((Interval::apply<Div>({1, 2}, {-1, 1}) == Bounds{-inf, inf}));
}

TEST_CASE("operands wholly outside the domain are undefined") {
    using namespace rtamt::functions;
    CHECK(Interval::undefined(Interval::apply<Sqrt>({-3, -1})));
    CHECK(Interval::undefined(Interval::apply<Ln>({-3, -1})));
    CHECK(Interval::undefined(Interval::apply<Log>({-3, -1}, {2, 2})));
    CHECK(Interval::undefined(Interval::apply<Pow>({-3, -1}, {0.5, 0.5})));
    CHECK(!Interval::undefined(Interval::apply<Pow>({-3, -1}, {2, 2})));
}
