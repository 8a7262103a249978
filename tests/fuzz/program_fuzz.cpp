// What libFuzzer calls: bytes that may be a program are refused in one sentence, or run safely.
//
// The first byte chooses the time domain and how the samples are cut, the rest is a program, whose
// checksum is set right here: else nothing that was changed would ever get past it.
#include "dense/executor.hpp"
#include "discrete/executor.hpp"
#include "program/crc32.hpp"
#include "program/program.hpp"
#include "values/algebra.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <span>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

namespace {

using rtamt::Domain;
using rtamt::Program;

constexpr std::size_t samples = 24;
constexpr std::size_t most_memory = std::size_t{1} << 22U;
constexpr std::int64_t longest_tail = 4096; // slots that finish() has to run
constexpr std::array<double, 8> values{0.0, 1.0, -1.0, 2.5, -3.0, rtamt::infinity, 0.5, -0.0};

// A sample of an input: small numbers, ties and infinities, the same in every run.
double value(std::size_t input, std::size_t sample, std::uint8_t seed) {
    return values[(input * 5 + sample * (1 + seed % 7U) + seed) % values.size()];
}

// Whatever is refused is refused in a sentence of the core's.
void expect_sentence(std::string_view what) {
    if (what.empty() || what.back() != '.') std::abort();
}

void run_discrete(const Program& program, std::uint8_t seed) {
    if (program.latest() > longest_tail) return;
    std::vector<std::vector<double>> columns(program.inputs);
    std::vector<const double*> pointers;
    for (std::size_t input = 0; input < columns.size(); ++input) {
        for (std::size_t i = 0; i < samples; ++i)
            columns[input].push_back(value(input, i, seed));
        pointers.push_back(columns[input].data());
    }
    const auto room = [&](auto&& count) {
        std::vector<std::vector<double>> rows;
        for (std::size_t output = 0; output < program.outputs.size(); ++output)
            rows.emplace_back(count(output));
        return rows;
    };
    const auto starts = [](std::vector<std::vector<double>>& rows) {
        std::vector<double*> begins;
        for (auto& row : rows)
            begins.push_back(row.data());
        return begins;
    };
    rtamt::discrete::Executor executor(program);
    std::vector<double> row(program.inputs);
    double value = 0.0;
    const std::size_t steps = seed % samples;
    for (std::size_t i = 0; i < steps; ++i) {
        for (std::size_t input = 0; input < row.size(); ++input)
            row[input] = columns[input][i];
        (void)executor.step(row.data(), value);
    }
    const auto count = static_cast<std::size_t>(samples - steps);
    auto known = room([&](std::size_t output) { return executor.known(output, count); });
    (void)executor.push(pointers, count, starts(known));
    auto rest = room([&](std::size_t output) { return executor.remaining(output); });
    (void)executor.finish(starts(rest));
    executor.reset();
    auto whole = room([&](std::size_t) { return samples; });
    (void)rtamt::discrete::Executor::evaluate(program, pointers, samples, starts(whole));
}

void run_dense(const Program& program, std::uint8_t seed) {
    using rtamt::dense::EventList;
    using rtamt::dense::Events;
    std::vector<std::vector<std::int64_t>> times(program.inputs);
    std::vector<std::vector<double>> columns(program.inputs);
    rtamt::dense::Executor executor(program);
    for (std::size_t input = 0; input < columns.size(); ++input) {
        std::int64_t time = seed % 5 - 2;
        for (std::size_t i = 0; i < samples; ++i) {
            times[input].push_back(time);
            columns[input].push_back(value(input, i, seed));
            time += 1 + static_cast<std::int64_t>((i * input + seed) % 4U);
        }
    }
    const auto cut = [&](std::size_t begin, std::size_t end) {
        std::vector<Events> events;
        for (std::size_t input = 0; input < columns.size(); ++input) {
            events.push_back(
                {times[input].data() + begin, columns[input].data() + begin, end - begin});
        }
        return events;
    };
    if (executor.last_possible() < 1000) return;
    std::vector<EventList> results(program.outputs.size());
    const std::size_t half = seed % samples;
    (void)executor.push(cut(0, half), results);
    (void)executor.push(cut(half, samples), results);
    (void)executor.finish(results);
    (void)executor.state_bytes();
    executor.reset();
    std::vector<EventList> whole(program.outputs.size());
    (void)rtamt::dense::Executor::evaluate(program, cut(0, samples), seed, whole);
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size < 5) return 0;
    const std::uint8_t seed = data[0];
    std::vector<std::uint8_t> bytes(data + 1, data + size);
    const std::uint32_t sum = rtamt::crc32(std::span(bytes).first(bytes.size() - 4));
    for (std::size_t i = 0; i < 4; ++i)
        bytes[bytes.size() - 4 + i] = static_cast<std::uint8_t>(sum >> (8U * i));
    const Domain domain = seed % 2 == 0 ? Domain::discrete : Domain::dense;
    try {
        const Program program = Program::parse(bytes, domain);
        if (domain == Domain::dense) {
            run_dense(program, seed);
        } else if (rtamt::discrete::Executor::memory(program) <= most_memory) {
            run_discrete(program, seed);
        }
    } catch (const std::invalid_argument& error) {
        expect_sentence(error.what());
    }
    return 0;
}
