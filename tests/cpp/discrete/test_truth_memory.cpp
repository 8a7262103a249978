#include "discrete/truth_memory.hpp"

#include "discrete/shift.hpp"
#include "discrete/until.hpp"
#include "discrete/window.hpp"
#include "programs.hpp"
#include "ways.hpp"

#include <memory>
#include <vector>

using namespace rtamt;
using namespace rtamt::discrete;

namespace {

using Word = TruthBits::Word;
using Made = std::unique_ptr<Kernel>;

constexpr double top = Real::top;
constexpr double bottom = Real::bottom;

// With any share of either value, so that stretches of every length occur.
oracle::Signal truths(std::size_t count, oracle::Random& random) {
    const std::int64_t share = random.between(1, 99);
    oracle::Signal signal(count);
    for (double& value : signal)
        value = random.chance(static_cast<int>(share)) ? top : bottom;
    return signal;
}

// Both run over the same blocks of one trace, and some are taken back from both.
template <class Make>
void check_alike(const Made& packed, const Made& plain, const Make& make, std::size_t width,
                 oracle::Random& random) {
    Made restored;
    Kernel* kernel = packed.get();
    std::int64_t slot = 0;
    const auto samples = static_cast<std::int64_t>(4 * width + 10);
    const auto end = samples + static_cast<std::int64_t>(2 * width + 10);
    while (slot < end) {
        const auto count = static_cast<std::size_t>(
            random.between(1, static_cast<std::int64_t>(random.chance(70) ? 70 : 2 * width + 70)));
        const auto check = [&](const oracle::Signal& a, const oracle::Signal& b) {
            oracle::Signal found(count);
            oracle::Signal expected(count);
            kernel->connect(a.data(), b.data(), found.data());
            plain->connect(a.data(), b.data(), expected.data());
            const Block block{slot, count, samples};
            CHECK(kernel->run(block) == Kernel::defined);
            CHECK(plain->run(block) == Kernel::defined);
            CHECK_MESSAGE(found == expected, ("width " + std::to_string(width)));
        };
        if (random.chance(40)) {
            kernel->checkpoint(count);
            plain->checkpoint(count);
            check(truths(count, random), truths(count, random));
            kernel->rollback();
            plain->rollback();
        }
        if (random.chance(20)) { // goes on elsewhere
            Snapshot written;
            kernel->transfer(written);
            Made other = make();
            Snapshot read(written.bytes());
            other->transfer(read);
            read.end();
            Snapshot again;
            other->transfer(again);
            CHECK(again.bytes() == written.bytes());
            restored = std::move(other);
            kernel = restored.get();
        }
        check(truths(count, random), truths(count, random));
        slot += static_cast<std::int64_t>(count);
        if (random.chance(2)) {
            kernel->reset();
            plain->reset();
            slot = 0;
        }
    }
}

template <class Packed, class Plain, class Cell, class... Arguments>
void check_ring(std::size_t width, oracle::Random& random, const Arguments&... arguments) {
    std::vector<std::unique_ptr<std::vector<Word>>> memory;
    const auto words = TruthBits::words(width);
    const auto make = [&]() -> Made {
        memory.push_back(std::make_unique<std::vector<Word>>(2 * words));
        Word* ring = memory.back()->data();
        return std::make_unique<Packed>(0, width, arguments..., ring, ring + words);
    };
    std::vector<Cell> cells(2 * width);
    const Made plain =
        std::make_unique<Plain>(0, width, arguments..., cells.data(), cells.data() + width);
    check_alike(make(), plain, make, width, random);
}

template <class Algebra>
void check_window(std::size_t width, oracle::Random& random) {
    const auto make = [&]() -> Made { return std::make_unique<TruthWindow<Algebra>>(0, width); };
    std::vector<double> cells(2 * width);
    const Made plain =
        std::make_unique<Slide<Algebra>>(0, width, cells.data(), cells.data() + width);
    check_alike(make(), plain, make, width, random);
}

std::vector<std::size_t> widths() {
    std::vector<std::size_t> widths{63, 64, 65, 66, 100, 127, 128, 129, 191, 192, 193, 1000, 1024};
    for (std::size_t width = 1; width <= 20; ++width)
        widths.push_back(width);
    return widths;
}

} // namespace

TEST_CASE("truth values in bits have the results of numbers, for every width") {
    oracle::Random random(1);
    for (const std::size_t width : widths()) {
        for (int round = 0; round < 4; ++round) {
            check_ring<TruthShift, Shift<double>, double>(width, random, top);
            check_ring<TruthShift, Shift<double>, double>(width, random, bottom);
            if (width > TruthBits::width) check_ring<TruthUntil, Until<Real>, Clamp>(width, random);
            check_window<Max>(width, random);
            check_window<Min>(width, random);
        }
    }
}

TEST_CASE("a program with wide windows of truth values has the same results in all ways") {
    ways::Random random(2);
    constexpr std::int64_t wide = least_packed + 70;
    for (const std::size_t count : std::initializer_list<std::size_t>{1, 700, 3000}) {
        const std::vector<ways::Signal> columns{random.signal(count), random.signal(count)};
        programs::Builder builder;
        const auto zero = builder.constant(0);
        const auto phi = builder.pointwise(Opcode::holds_ge, builder.input(), zero);
        const auto psi = builder.pointwise(Opcode::holds_gt, builder.input(), zero);
        builder.output(builder.unary(Opcode::slide_max, phi, wide, 0));
        builder.output(builder.unary(Opcode::slide_min, psi, wide, wide - 1));
        builder.output(builder.unary(Opcode::shift, phi, wide, 0, bottom));
        builder.output(builder.later(psi, wide));
        builder.output(builder.binary(Opcode::until, phi, psi, wide, wide - 1));
        Program program = builder.program();
        const std::size_t before = Executor::memory(program);
        for (Instruction& instruction : program.instructions)
            instruction.truth = program.is_truth(instruction);
        CHECK(program.instructions.back().truth);
        CHECK(Executor::memory(program) * 30 < before);
        ways::check_all_ways(program, columns, count, random, "count " + std::to_string(count));
    }
}

TEST_CASE("only values that are infinite wherever they are present are truth values") {
    programs::Builder builder;
    const auto x = builder.input();
    const auto holds = builder.pointwise(Opcode::holds_ge, x, builder.constant(0));
    const auto zero_before = builder.unary(Opcode::shift, holds, 5, 0, 0.0);
    const auto hidden = builder.later(holds, 5);
    const auto mixed = builder.pointwise(Opcode::min, holds, x);
    const auto over_mixed = builder.unary(Opcode::slide_min, mixed, 5, 0);
    const auto both = builder.pointwise(Opcode::min, holds, builder.constant(top));
    Program program = builder.program();
    for (Instruction& instruction : program.instructions)
        instruction.truth = program.is_truth(instruction);
    const auto& all = program.instructions;
    CHECK_FALSE(all[x].truth);
    CHECK(all[holds].truth);
    CHECK_FALSE(all[zero_before].truth);
    CHECK(all[hidden].truth);
    CHECK_FALSE(all[mixed].truth);
    CHECK_FALSE(all[over_mixed].truth);
    CHECK(all[both].truth);
}
