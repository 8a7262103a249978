// The engine beside loops written by hand for one formula each: what generality costs.
//
//     fused_bench [samples] [rounds]
//
// Prints a line of JSON a formula: medians, in nanoseconds a sample, of both in turn. Both read the
// same two columns and write the robustness of every sample; the values must be equal. Both are
// compiled for the same processor: like the engine's kernels, the loops run in the vectors that
// vectors.hpp finds. The executor is kept from one trace to the next, as specifications keep it.
#include "discrete/executor.hpp"
#include "programs.hpp"
#include "values/vectors.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <limits>
#include <random>
#include <utility>
#include <vector>

namespace {

using programs::Builder;
using rtamt::Opcode;
using rtamt::Program;
using rtamt::discrete::Executor;
using Column = std::vector<double>;

constexpr double infinity = std::numeric_limits<double>::infinity();

// A formula written by hand: what vectors.hpp compiles for every machine and for AVX2.
struct Samples {
    const double* a;
    const double* b;
    std::size_t n;
};

[[nodiscard]] RTAMT_INLINE double least(double a, double b) noexcept {
    return a < b ? a : b;
}
[[nodiscard]] RTAMT_INLINE double most(double a, double b) noexcept {
    return a > b ? a : b;
}

// ---- a + b >= -2 and a - b <= 3 -----------------------------------------------------------------

Program both() {
    Builder builder;
    const auto a = builder.input();
    const auto b = builder.input();
    const auto sum = builder.pointwise(Opcode::add, a, b);
    const auto low = builder.pointwise(Opcode::sub, sum, builder.constant(-2));
    const auto difference = builder.pointwise(Opcode::sub, a, b);
    const auto high = builder.pointwise(Opcode::sub, builder.constant(3), difference);
    builder.output(builder.pointwise(Opcode::min, low, high));
    return builder.program();
}

struct BothByHand {
    RTAMT_INLINE static void over(Samples in, double* out) noexcept {
        for (std::size_t i = 0; i < in.n; ++i)
            out[i] = least(in.a[i] + in.b[i] + 2, 3 - (in.a[i] - in.b[i]));
    }
};

// ---- always[0,100](a + b >= -2) -----------------------------------------------------------------

constexpr std::size_t width = 101;

Program always() {
    Builder builder;
    const auto a = builder.input();
    const auto b = builder.input();
    const auto sum = builder.pointwise(Opcode::add, a, b);
    const auto margin = builder.pointwise(Opcode::sub, sum, builder.constant(-2));
    builder.output(builder.unary(Opcode::slide_min, margin, width, width - 1));
    return builder.program();
}

// Van Herk's and Gil and Werman's algorithm over margins that are computed on the way: stretches of
// the width of the window, of each the minima from its samples to its end.
struct AlwaysByHand {
    RTAMT_INLINE static void over(Samples in, double* out) noexcept {
        const auto [a, b, n] = in;
        double to_end[width];
        for (std::size_t begin = 0; begin < n; begin += width) {
            const std::size_t count = std::min(width, n - begin);
            double tail = infinity;
            for (std::size_t i = count; i-- > 0;) {
                tail = least(a[begin + i] + b[begin + i] + 2, tail);
                to_end[i] = tail;
            }
            out[begin] = to_end[0];
            const std::size_t next = begin + width;
            const std::size_t ahead = next < n ? std::min(width - 1, n - next) : 0;
            double head = infinity;
            for (std::size_t i = 0; i < ahead; ++i) {
                head = least(a[next + i] + b[next + i] + 2, head);
                if (i + 1 < count) out[begin + i + 1] = least(to_end[i + 1], head);
            }
            for (std::size_t i = ahead; i + 1 < count; ++i)
                out[begin + i + 1] = least(to_end[i + 1], head);
        }
    }
};

// ---- historically[0,100](once[5,5](a >= 3) -> once[0,5](b >= 3)) --------------------------------

constexpr std::size_t delay = 5;

Program response() {
    Builder builder;
    const auto a = builder.input();
    const auto b = builder.input();
    const auto three = builder.constant(3);
    const auto request = builder.pointwise(Opcode::sub, a, three);
    const auto grant = builder.pointwise(Opcode::sub, b, three);
    const auto none = builder.pointwise(Opcode::neg, request);
    const auto before = builder.unary(Opcode::shift, none, delay, 0, infinity);
    const auto once = builder.unary(Opcode::slide_max, grant, delay + 1, 0);
    const auto implied = builder.pointwise(Opcode::max, before, once);
    builder.output(builder.unary(Opcode::slide_min, implied, width, 0));
    return builder.program();
}

[[nodiscard]] RTAMT_INLINE double implied_at(const double* a, const double* b,
                                             std::size_t i) noexcept {
    if (i < delay) return infinity; // nobody asked
    double grant = b[i];
    for (std::size_t back = 1; back <= delay; ++back)
        grant = most(grant, b[i - back]);
    return most(3 - a[i - delay], grant - 3);
}

struct ResponseByHand {
    RTAMT_INLINE static void over(Samples in, double* out) noexcept {
        const auto [a, b, n] = in;
        double to_end[width]; // of the stretch before
        std::fill_n(to_end, width, infinity);
        double values[width];
        for (std::size_t begin = 0; begin < n; begin += width) {
            const std::size_t count = std::min(width, n - begin);
            for (std::size_t i = 0; i < count; ++i)
                values[i] = implied_at(a, b, begin + i);
            double head = infinity;
            for (std::size_t i = 0; i < count; ++i) {
                head = least(values[i], head);
                out[begin + i] = i + 1 < width ? least(to_end[i + 1], head) : head;
            }
            double tail = infinity;
            for (std::size_t i = count; i-- > 0;) {
                tail = least(values[i], tail);
                to_end[i] = tail;
            }
        }
    }
};

// ---- both in turn -------------------------------------------------------------------------------

// Nanoseconds of the processor's time: what else the machine does must not count.
[[nodiscard]] double now() noexcept {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return 1e9 * static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec);
}

template <class Work>
[[nodiscard]] double spent(std::size_t samples, Work&& work) {
    const double start = now();
    std::forward<Work>(work)();
    return (now() - start) / static_cast<double>(samples);
}

[[nodiscard]] double median(std::vector<double> figures) {
    std::ranges::sort(figures);
    return figures[figures.size() / 2];
}

template <class ByHand>
bool compare(const char* name, const Program& program, const Column& a, const Column& b,
             std::size_t rounds) {
    const std::vector<const double*> columns{a.data(), b.data()};
    Column ours(a.size());
    Column theirs(a.size());
    const std::vector<double*> outputs{ours.data()};
    Executor executor(program);
    std::vector<double> engine;
    std::vector<double> hand;
    std::vector<double> ratio;
    for (std::size_t round = 0; round <= rounds; ++round) {
        const double first = spent(a.size(), [&] {
            if (executor.evaluate(columns, a.size(), outputs)) std::abort();
        });
        const Samples in{a.data(), b.data(), a.size()};
        const double second =
            spent(a.size(), [&] { rtamt::vectorised<ByHand>(in.n, in, theirs.data()); });
        if (round == 0) continue; // memory is touched for the first time
        engine.push_back(first);
        hand.push_back(second);
        ratio.push_back(first / second);
    }
    if (ours != theirs) {
        std::fprintf(stderr, "%s: the values differ\n", name);
        return false;
    }
    std::printf("{\"formula\": \"%s\", \"engine\": %.4f, \"hand\": %.4f, \"ratio\": %.4f}\n", name,
                median(engine), median(hand), median(ratio));
    return true;
}

} // namespace

int main(int argc, const char* const* argv) {
    const std::size_t samples = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 1'000'000;
    const std::size_t rounds = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 15;
    std::mt19937 engine(1);
    std::normal_distribution<double> normal;
    Column a(samples);
    Column b(samples);
    for (std::size_t i = 0; i < samples; ++i) {
        a[i] = normal(engine);
        b[i] = normal(engine);
    }
    bool equal = compare<BothByHand>("a + b >= -2 and a - b <= 3", both(), a, b, rounds);
    equal = compare<AlwaysByHand>("always[0:100](a + b >= -2)", always(), a, b, rounds) && equal;
    equal = compare<ResponseByHand>("historically[0:100](once[5:5](a >= 3) -> once[0:5](b >= 3))",
                                    response(), a, b, rounds) &&
            equal;
    return equal ? 0 : 1;
}
