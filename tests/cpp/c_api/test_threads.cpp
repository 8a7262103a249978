// What threads may share: the bytes of a program, a parsed program, and monitors that one thread at
// a time uses. Under ThreadSanitizer (preset `tsan`) every access that is not ordered is an error.
#include "c_api/rtamt.h"
#include "dense/executor.hpp"
#include "discrete/executor.hpp"

#include "check.hpp"
#include "programs.hpp"

#include <array>
#include <bit>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace {
constexpr int threads = 4;
constexpr int samples = 300;

// Calls work(thread) in each thread at once and returns what it answered.
template <class Work>
auto at_once(Work&& work) {
    std::vector<decltype(work(0))> answers(threads);
    std::vector<std::thread> running;
    running.reserve(threads);
    for (int thread = 0; thread < threads; ++thread) {
        running.emplace_back(
            [&, thread] { answers[static_cast<std::size_t>(thread)] = work(thread); });
    }
    for (std::thread& each : running)
        each.join();
    return answers;
}

using Row = std::array<double, 2>;
using Bits = std::vector<std::uint64_t>; // of numbers

Row row(int i) {
    return {static_cast<double>(i * 5 % 7) - 3.0, 1.0 + i % 3};
}

rtamt_monitor* create(const std::vector<std::uint8_t>& bytes) {
    rtamt_monitor* monitor = nullptr;
    std::array<char, 99> message{};
    CHECK(rtamt_create(bytes.data(), bytes.size(), &monitor, message.data(), message.size()) ==
          RTAMT_OK);
    return monitor;
}

void step(rtamt_monitor* monitor, int i, Bits& bits) {
    rtamt_value known{};
    if (rtamt_step(monitor, row(i).data(), 2, &known, 1) != RTAMT_OK) {
        bits.push_back(std::string(rtamt_message(monitor)).size());
    }
    bits.push_back(std::bit_cast<std::uint64_t>(known.value));
}

// All that a monitor of discrete time offers.
Bits discrete_run(const std::vector<std::uint8_t>& bytes) {
    rtamt_monitor* monitor = create(bytes);
    Bits bits;
    for (int i = 0; i < samples; ++i)
        step(monitor, i, bits);
    std::size_t size = 0;
    CHECK(rtamt_save(monitor, nullptr, 0, &size) == RTAMT_OK);
    std::vector<std::uint8_t> state(size);
    CHECK(rtamt_save(monitor, state.data(), size, &size) == RTAMT_OK);
    rtamt_monitor* copy = nullptr;
    CHECK(rtamt_clone(monitor, &copy) == RTAMT_OK);
    step(copy, 5, bits);
    rtamt_destroy(copy);
    CHECK(rtamt_reset(monitor) == RTAMT_OK);
    CHECK(rtamt_restore(monitor, state.data(), state.size()) == RTAMT_OK);
    (void)rtamt_finish(monitor);
    const double* values = nullptr;
    const std::size_t count = rtamt_last_output(monitor, 0, nullptr, &values);
    for (std::size_t i = 0; i < count; ++i)
        bits.push_back(std::bit_cast<std::uint64_t>(values[i]));
    rtamt_destroy(monitor);
    return bits;
}

Bits dense_run(const std::vector<std::uint8_t>& bytes) {
    rtamt_monitor* monitor = create(bytes);
    Bits bits;
    const auto read = [&] {
        const double* values = nullptr;
        const std::size_t count = rtamt_last_output(monitor, 0, nullptr, &values);
        for (std::size_t i = 0; i < count; ++i)
            bits.push_back(std::bit_cast<std::uint64_t>(values[i]));
    };
    for (int i = 0; i < samples; ++i) {
        const std::int64_t tick = std::int64_t{2} * i;
        const std::array<rtamt_sample, 2> both{rtamt_sample{tick, row(i)[0], 0},
                                               rtamt_sample{tick + i % 2, row(i)[1], 1}};
        CHECK(rtamt_push(monitor, both.data(), both.size()) == RTAMT_OK);
        read();
    }
    CHECK(rtamt_finish(monitor) == RTAMT_OK);
    read();
    rtamt_destroy(monitor);
    return bits;
}
} // namespace

TEST_CASE("monitors in threads of their own are independent") {
    const auto discrete = programs::bytes_of(programs::everything());
    const auto dense = programs::bytes_of(programs::everything_dense());
    const Bits expected[] = {discrete_run(discrete), dense_run(dense)};
    const auto answers = at_once(
        [&](int thread) { return thread % 2 == 0 ? discrete_run(discrete) : dense_run(dense); });
    for (int thread = 0; thread < threads; ++thread)
        CHECK(answers[static_cast<std::size_t>(thread)] == expected[thread % 2]);
}

TEST_CASE("threads share a parsed program") {
    const programs::Program discrete = programs::everything();
    const auto run = [&](int /*thread*/) {
        rtamt::discrete::Executor executor(discrete);
        Bits bits;
        for (int i = 0; i < samples; ++i) {
            double known = 0.0;
            const auto outcome = executor.step(row(i).data(), known);
            bits.push_back(static_cast<std::uint64_t>(outcome));
            bits.push_back(std::bit_cast<std::uint64_t>(known));
        }
        return bits;
    };
    const Bits expected = run(0);
    for (const Bits& bits : at_once(run))
        CHECK(bits == expected);
}

TEST_CASE("threads take turns with a monitor") {
    const auto bytes = programs::bytes_of(programs::everything());
    rtamt_monitor* monitor = create(bytes);
    std::mutex turn;
    std::int64_t taken = 0;
    (void)at_once([&](int thread) {
        for (int i = 0; i < samples; ++i) {
            const std::scoped_lock guard(turn);
            rtamt_value known{};
            if (rtamt_step(monitor, row(i + thread).data(), 2, &known, 1) == RTAMT_OK) ++taken;
        }
        return 0;
    });
    CHECK((taken > samples && rtamt_sample_count(monitor) == taken));
    rtamt_destroy(monitor);
}
