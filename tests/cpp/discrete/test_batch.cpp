// Plans over many traces, against the executor and the scans over one trace after the other.
#include "discrete/batch.hpp"

#include "check.hpp"
#include "discrete/executor.hpp"
#include "discrete/scan.hpp"
#include "domain_programs.hpp"
#include "oracle.hpp"
#include "random_programs.hpp"

#include <bit>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

using namespace rtamt;
using oracle::Random;
using programs::Builder;
using rtamt::discrete::Batch;
using rtamt::discrete::Executor;
using Column = std::vector<double>;

namespace {

// The values of one trace; nothing where one is undefined.
std::optional<Column> alone(const std::vector<Stage>& stages, std::vector<Column> columns,
                            std::size_t count) {
    std::vector<Column> values;
    for (const Stage& stage : stages) {
        std::vector<const double*> inputs;
        for (const std::size_t column : stage.columns)
            inputs.push_back(columns[column].data());
        values.assign(stage.program.outputs.size(), Column(count));
        std::vector<double*> outputs;
        for (Column& value : values)
            outputs.push_back(value.data());
        if (Executor::evaluate(stage.program, inputs, count, outputs)) return std::nullopt;
        for (const Scan& scan : stage.scans) {
            Column scanned(count);
            if (scan.kind == ScanKind::run_max) {
                discrete::scan<Max>(values[scan.a], scanned);
            } else if (scan.kind == ScanKind::run_min) {
                discrete::scan<Min>(values[scan.a], scanned);
            } else {
                discrete::scan_until<Real>(values[scan.a], values[scan.b], scanned);
            }
            columns.push_back(std::move(scanned));
        }
    }
    return values.front();
}

// One stage, or a scan of any kind and what reads it.
std::vector<Stage> random_stages(Random& random, bool truths) {
    const auto size = static_cast<int>(random.between(1, 12));
    Stage first{truths ? programs::truth_program(random, size)
                       : programs::random_program(random, size),
                {0, 1},
                {}};
    if (random.chance(40)) {
        first.program.outputs.resize(1);
        return {first};
    }
    const std::size_t last = first.program.outputs.size() - 1;
    first.scans = {{static_cast<ScanKind>(random.between(0, 2)), 0, last}};
    Builder second;
    const auto x = second.input();
    const auto y = second.input();
    const auto scanned = second.input();
    if (random.chance(40)) {
        second.output(scanned);
    } else {
        const auto high = second.pointwise(Opcode::holds_ge, x, y);
        const auto before = second.unary(Opcode::slide_max, high, 4, random.chance(50) ? 3 : 0);
        const auto aligned = second.later(scanned, second.lag(before));
        second.output(second.pointwise(Opcode::min, before, aligned));
    }
    return {first, {second.program(), {0, 1, 2}, {}}};
}

bool same_bits(const Column& expected, const double* found) {
    for (std::size_t i = 0; i < expected.size(); ++i) {
        if (std::bit_cast<std::uint64_t>(expected[i]) != std::bit_cast<std::uint64_t>(found[i])) {
            return false;
        }
    }
    return true;
}

} // namespace

TEST_CASE("many traces get the bits that each gets alone") {
    Random random(1);
    int undefined = 0;
    int words = 0;
    for (int round = 0; round < 300; ++round) {
        const std::string note = "round " + std::to_string(round);
        const bool truths = random.chance(60);
        const auto stages = random_stages(random, truths);
        Batch batch(stages, 2);
        words += batch.joins_words() ? 1 : 0;
        for (int again = 0; again < 2; ++again) {
            const auto width = static_cast<std::size_t>(
                random.chance(4) ? random.between(4000, 4200) : random.between(1, 150));
            const auto count = static_cast<std::size_t>(
                random.between(random.chance(50) ? static_cast<std::int64_t>(width) : 1,
                               static_cast<std::int64_t>(width)));
            const auto traces = static_cast<std::size_t>(width > 1000 ? 9 : random.between(0, 90));
            std::vector<Column> columns(2, Column(traces * width));
            for (Column& column : columns) {
                for (double& x : column)
                    x = random.number(truths ? 0 : 3);
            }
            std::vector<std::int64_t> rows;
            for (std::size_t i = 0; i < traces; ++i) {
                if (count == width || random.chance(70)) {
                    rows.push_back(static_cast<std::int64_t>(i));
                }
            }
            Column results(traces * width, 7.0);
            const std::vector<const double*> pointers{columns[0].data(), columns[1].data()};
            const bool defined = batch.evaluate({pointers, rows, width, count, results.data()});
            bool all = true;
            for (const std::int64_t row : rows) {
                std::vector<Column> one;
                for (const Column& column : columns) {
                    const auto begin = column.begin() + row * static_cast<std::ptrdiff_t>(width);
                    one.emplace_back(begin, begin + static_cast<std::ptrdiff_t>(count));
                }
                const auto expected = alone(stages, one, count);
                all = all && expected;
                if (!defined || !expected) continue;
                const double* found = results.data() + static_cast<std::size_t>(row) * width;
                CHECK_MESSAGE(same_bits(*expected, found), note);
                CHECK_MESSAGE((count == width || found[count] == 7.0), note);
            }
            CHECK_MESSAGE(defined == all, note);
            undefined += defined ? 0 : 1;
        }
    }
    CHECK(undefined > 20);
    CHECK((words > 60 && words < 250));
}

TEST_CASE("a longer trace is evaluated in pieces that fill whole words") {
    Builder builder;
    const auto high = builder.pointwise(Opcode::holds_ge, builder.input(), builder.constant(0));
    builder.output(builder.unary(Opcode::slide_min, high, 100, 99));
    const std::vector<Stage> stages{{builder.program(), {0}, {}}};
    Random random(2);
    constexpr std::size_t width = 10'001;
    constexpr std::size_t traces = 70;
    Column samples(traces * width);
    for (double& x : samples)
        x = random.chance(98) ? 1.0 : -1.0;
    std::vector<std::int64_t> rows(traces);
    std::iota(rows.begin(), rows.end(), 0);
    Column results(samples.size());
    Batch batch(stages, 1);
    CHECK(batch.joins_words());
    const std::vector<const double*> pointers{samples.data()};
    CHECK(batch.evaluate({pointers, rows, width, width, results.data()}));
    for (std::size_t row = 0; row < traces; ++row) {
        const Column one(samples.begin() + static_cast<std::ptrdiff_t>(row * width),
                         samples.begin() + static_cast<std::ptrdiff_t>((row + 1) * width));
        CHECK(same_bits(*alone(stages, {one}, width), results.data() + row * width));
    }
}

TEST_CASE("a plan has one result, and reads what is there") {
    Builder builder;
    const auto x = builder.input();
    builder.output(x).output(x);
    const auto made = [](std::vector<Stage> stages) {
        return thrown<std::invalid_argument>([&] { const Batch batch(std::move(stages), 1); });
    };
    const std::string one = "The last program of a plan has one output.";
    const std::string there = "A program of a plan reads what is not there.";
    CHECK(made({}) == one);
    CHECK(made({{builder.program(), {0}, {}}}) == one);
    CHECK(made({{builder.program(), {1}, {}}}) == there);
    CHECK(made({{builder.program(), {}, {}}}) == there);
    CHECK(made({{builder.program(), {0}, {{ScanKind::until, 0, 2}}}}) == there);
}
