// Runs programs in every way there is, so that a kernel's test is one call.
#pragma once

#include "check.hpp"
#include "discrete/executor.hpp"
#include "oracle.hpp"

#include <string>
#include <vector>

namespace ways {

using oracle::Random;
using oracle::Signal;
using rtamt::Program;
using rtamt::discrete::Executor;
using rtamt::discrete::Failure;
using rtamt::discrete::Outcome;

inline std::vector<const double*> pointers(const std::vector<Signal>& columns, std::size_t offset) {
    std::vector<const double*> result;
    for (const Signal& column : columns)
        result.push_back(column.data() + offset);
    return result;
}

inline std::vector<double*> pointers(std::vector<Signal>& signals) {
    std::vector<double*> result;
    for (Signal& signal : signals)
        result.push_back(signal.data());
    return result;
}

// Buffers of exactly the promised size, so that the sanitizer sees one value too many.
inline std::vector<Signal> buffers_for_push(const Executor& executor, std::size_t count) {
    std::vector<Signal> buffers;
    for (std::size_t i = 0; i < executor.program().outputs.size(); ++i) {
        buffers.emplace_back(executor.known(i, count));
    }
    return buffers;
}

inline std::vector<Signal> buffers_for_finish(const Executor& executor) {
    std::vector<Signal> buffers;
    for (std::size_t i = 0; i < executor.program().outputs.size(); ++i) {
        buffers.emplace_back(executor.remaining(i));
    }
    return buffers;
}

inline void append(std::vector<Signal>& signals, const std::vector<Signal>& more) {
    for (std::size_t i = 0; i < signals.size(); ++i) {
        signals[i].insert(signals[i].end(), more[i].begin(), more[i].end());
    }
}

// Pushes samples [begin, begin + count); appends what became known.
inline std::optional<Failure> push(Executor& executor, const std::vector<Signal>& columns,
                                   std::size_t begin, std::size_t count,
                                   std::vector<Signal>& outputs) {
    auto buffers = buffers_for_push(executor, count);
    const auto targets = pointers(buffers);
    const auto failure = executor.push(pointers(columns, begin), count, targets);
    if (!failure) append(outputs, buffers);
    return failure;
}

inline std::optional<Failure> finish(Executor& executor, std::vector<Signal>& outputs) {
    auto buffers = buffers_for_finish(executor);
    const auto targets = pointers(buffers);
    const auto failure = executor.finish(targets);
    if (!failure) append(outputs, buffers);
    return failure;
}

// Online in chunks of random size up to `largest`, then finish().
inline std::vector<Signal> online(Executor& executor, const std::vector<Signal>& columns,
                                  std::size_t count, Random& random, std::int64_t largest) {
    std::vector<Signal> outputs(executor.program().outputs.size());
    for (std::size_t begin = 0; begin < count;) {
        const auto chunk = std::min<std::size_t>(
            count - begin, static_cast<std::size_t>(random.between(1, largest)));
        CHECK(!push(executor, columns, begin, chunk, outputs));
        begin += chunk;
    }
    CHECK(!finish(executor, outputs));
    return outputs;
}

inline std::optional<Failure> offline(const Program& program, const std::vector<Signal>& columns,
                                      std::size_t count, std::vector<Signal>& outputs) {
    outputs.assign(program.outputs.size(), Signal(count));
    const auto targets = pointers(outputs);
    return Executor::evaluate(program, pointers(columns, 0), count, targets);
}

// Makes an executor that has run go on where another one of the same program is.
inline void copy(Executor& from, Executor& to) {
    rtamt::Snapshot written;
    from.transfer(written);
    rtamt::Snapshot read(written.bytes());
    to.transfer(read);
    read.end();
}

// A copy made anywhere in the trace goes on as if it had seen all of it, whatever the original
// does.
inline void check_copy(const Program& program, const std::vector<Signal>& columns,
                       std::size_t count, Random& random, const std::vector<Signal>& expected,
                       const std::string& note) {
    const auto seen = static_cast<std::size_t>(random.between(0, static_cast<int>(count)));
    std::vector<Signal> outputs(program.outputs.size());
    Executor original(program);
    CHECK(!push(original, columns, 0, seen / 2, outputs));
    CHECK(!push(original, columns, seen / 2, seen - seen / 2, outputs));
    Executor twin(program);
    copy(original, twin);
    auto others = outputs;
    CHECK(!finish(original, others));
    CHECK(!push(twin, columns, seen, count - seen, outputs));
    CHECK(!finish(twin, outputs));
    CHECK_MESSAGE(outputs == expected, (note + ", copied at " + std::to_string(seen)));
    copy(twin, original);
    CHECK((original.finished() && original.samples() == static_cast<std::int64_t>(count)));
}

// The one thing to check of a program that cannot fail: offline, online in any chunks, copied, and
// again after a reset, it gives what the definition gives.
inline void check_all_ways(const Program& program, const std::vector<Signal>& columns,
                           std::size_t count, Random& random, const std::string& note) {
    const auto expected = oracle::answer(program, columns, count);
    CHECK_MESSAGE(!expected.undefined, note);
    std::vector<Signal> outputs;
    CHECK_MESSAGE(!offline(program, columns, count, outputs), note);
    CHECK_MESSAGE(outputs == expected.outputs, note);
    Executor executor(program);
    for (const std::int64_t largest : {1, 7, 300, 2000}) {
        CHECK_MESSAGE(online(executor, columns, count, random, largest) == expected.outputs,
                      (note + ", chunks up to " + std::to_string(largest)));
        CHECK(executor.finished());
        executor.reset();
    }
    check_copy(program, columns, count, random, expected.outputs, note);
}

} // namespace ways
