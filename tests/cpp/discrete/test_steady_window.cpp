#include "discrete/steady_window.hpp"

#include "programs.hpp"
#include "ways.hpp"

#include <vector>

using namespace rtamt;
using rtamt::discrete::Operands;
using rtamt::discrete::SteadyWindow;
using rtamt::discrete::TwoStack;

namespace {

// The same elements go to both, and some are taken back from both.
template <Monoid M>
void check_against_two_stacks(std::size_t width, oracle::Random& random) {
    std::vector<typename M::Element> cells(4 * width);
    SteadyWindow<M> steady(width, cells.data(), cells.data() + width);
    TwoStack<M> stacks(width, cells.data() + 2 * width, cells.data() + 3 * width);
    const auto check = [&](auto&& step, std::size_t count) {
        std::vector<double> results(count);
        std::vector<double> expected(count);
        step(steady, results.data());
        step(stacks, expected.data());
        CHECK_MESSAGE(results == expected, ("width " + std::to_string(width)));
    };
    for (std::size_t done = 0; done < 5 * width;) {
        const auto count = static_cast<std::size_t>(
            random.between(1, static_cast<std::int64_t>(random.chance(70) ? 3 : 2 * width)));
        const oracle::Signal a = random.signal(count);
        const oracle::Signal b = random.signal(count);
        const auto push = [&](auto& window, double* out) {
            window.push({a.data(), b.data()}, out, count);
        };
        if (random.chance(40)) {
            steady.checkpoint(count);
            stacks.checkpoint(count);
            check(push, count);
            steady.rollback();
            stacks.rollback();
        }
        check(push, count);
        if (random.chance(20)) { // goes on elsewhere
            Snapshot written;
            steady.transfer(written);
            steady = SteadyWindow<M>(width, cells.data(), cells.data() + width);
            Snapshot read(written.bytes());
            steady.transfer(read);
            read.end();
        }
        if (random.chance(3)) {
            steady.reset();
            stacks.reset();
        }
        done += count;
    }
    check([&](auto& window, double* out) { window.expire(out, width); }, width);
}

} // namespace

TEST_CASE("steady windows have the results of two stacks for every width") {
    oracle::Random random(1);
    for (std::size_t width = 2; width <= 40; ++width) {
        for (int round = 0; round < 5; ++round) {
            check_against_two_stacks<Joined<Max>>(width, random);
            check_against_two_stacks<Joined<Min>>(width, random);
            check_against_two_stacks<UntilSteps<Real>>(width, random);
        }
    }
    for (const std::size_t width : {63U, 64U, 65U, 999U, 1000U, 1001U}) {
        check_against_two_stacks<Joined<Max>>(width, random);
        check_against_two_stacks<UntilSteps<Real>>(width, random);
    }
}

TEST_CASE("programs for the worst case have the results of others in all ways") {
    ways::Random random(2);
    for (const std::size_t count : std::initializer_list<std::size_t>{0, 1, 2, 10, 257, 700}) {
        const std::vector<ways::Signal> columns{random.signal(count), random.signal(count)};
        for (const std::int64_t width : {1, 2, 3, 4, 9, 100, 257, 800}) {
            programs::Builder builder;
            const auto a = builder.input();
            const auto b = builder.input();
            builder.output(builder.unary(Opcode::slide_max, a, width, 0));
            builder.output(builder.unary(Opcode::slide_min, b, width, width - 1));
            builder.output(builder.binary(Opcode::until, a, b, width, width - 1));
            Program program = builder.program();
            for (Instruction& instruction : program.instructions)
                instruction.steady = true;
            ways::check_all_ways(program, columns, count, random,
                                 "width " + std::to_string(width) + ", count " +
                                     std::to_string(count));
        }
    }
}
