// Runs programs over events in every way there is, so that a kernel's test is one call.
#pragma once

#include "check.hpp"
#include "dense/executor.hpp"
#include "oracle.hpp"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace ways {

using dense_oracle::Random;
using dense_oracle::Signal;
using dense_oracle::Trace;
using rtamt::Program;
using rtamt::dense::EventList;
using rtamt::dense::Events;
using rtamt::dense::Executor;
using rtamt::dense::Failure;

inline std::vector<Signal> signals_of(const std::vector<EventList>& lists) {
    std::vector<Signal> signals;
    for (const EventList& list : lists)
        signals.push_back(dense_oracle::signal_of(list.view()));
    return signals;
}

inline std::optional<Failure> offline(const Program& program, const Trace& trace,
                                      std::vector<Signal>& outputs, std::int64_t extra = 0) {
    std::vector<Events> inputs;
    for (const Signal& signal : trace)
        inputs.push_back(signal.events(0, signal.size()));
    std::vector<EventList> lists(program.outputs.size());
    const auto failure = Executor::evaluate(program, inputs, extra, lists);
    outputs = signals_of(lists);
    return failure;
}

// A trace on its way into an executor.
class Online {
  public:
    Online(Executor& executor, const Trace& trace)
        : outputs(executor.program().outputs.size()), executor_(executor), trace_(trace),
          accepted_(trace.size(), 0) {}

    // The same trace from here on into a copy of the executor.
    Online(Executor& executor, const Online& first)
        : outputs(first.outputs.size()), executor_(executor), trace_(first.trace_),
          accepted_(first.accepted_) {
        for (std::size_t i = 0; i < outputs.size(); ++i)
            outputs[i].append(first.outputs[i].view());
    }

    // So many of the next events of each input, in memory of their own that is gone afterwards.
    std::optional<Failure> push(const std::vector<std::size_t>& counts) {
        Trace chunk;
        std::vector<Events> inputs;
        for (std::size_t i = 0; i < trace_.size(); ++i) {
            chunk.emplace_back();
            for (std::size_t k = 0; k < counts[i]; ++k)
                chunk[i].add(trace_[i].times[accepted_[i] + k], trace_[i].values[accepted_[i] + k]);
        }
        for (const Signal& signal : chunk)
            inputs.push_back(signal.events(0, signal.size()));
        const auto failure = executor_.push(inputs, outputs);
        if (failure) return failure;
        for (std::size_t i = 0; i < trace_.size(); ++i)
            accepted_[i] += counts[i];
        return failure;
    }

    std::vector<std::size_t> random_counts(Random& random, std::int64_t largest) const {
        std::vector<std::size_t> counts;
        for (std::size_t i = 0; i < trace_.size(); ++i) {
            const auto rest = static_cast<std::int64_t>(trace_[i].size() - accepted_[i]);
            const bool some = largest > 1 || random.chance(60);
            counts.push_back(
                static_cast<std::size_t>(some ? std::min(rest, random.between(0, largest)) : 0));
        }
        return counts;
    }

    [[nodiscard]] bool done() const {
        for (std::size_t i = 0; i < trace_.size(); ++i) {
            if (accepted_[i] != trace_[i].size()) return false;
        }
        return true;
    }

    // What came in so far; nothing where an input has not come yet.
    [[nodiscard]] std::optional<Trace> accepted() const {
        Trace trace;
        for (std::size_t i = 0; i < trace_.size(); ++i) {
            if (accepted_[i] == 0) return std::nullopt;
            trace.push_back(trace_[i].first(accepted_[i]));
        }
        return trace;
    }

    // Whether exactly what is known has been reported, given the whole result.
    [[nodiscard]] bool exact(const std::vector<Signal>& expected) const {
        const auto trace = accepted();
        for (std::size_t i = 0; i < outputs.size(); ++i) {
            const Program& program = executor_.program();
            const std::int64_t lag = program.instructions[program.outputs[i]].lag;
            std::optional<std::int64_t> known;
            if (trace &&
                dense_oracle::frontier_of(*trace) - lag >= dense_oracle::start_of(*trace)) {
                known = dense_oracle::frontier_of(*trace) - lag;
            }
            if (executor_.known_until(i) != known) return false;
            const Signal reported = dense_oracle::signal_of(outputs[i].view());
            if (reported != (known ? expected[i].merged(*known) : Signal{})) return false;
        }
        return true;
    }

    std::vector<EventList> outputs;

  private:
    Executor& executor_;
    const Trace& trace_;
    std::vector<std::size_t> accepted_;
};

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
inline void check_copy(const Program& program, const Trace& trace, Random& random,
                       const std::vector<Signal>& expected, const std::string& note) {
    Executor original(program);
    Online begun(original, trace);
    for (std::int64_t updates = random.between(0, 6); updates > 0; --updates)
        CHECK_MESSAGE(!begun.push(begun.random_counts(random, 5)), note);
    Executor twin(program);
    copy(original, twin);
    Online branch(twin, begun);
    CHECK_MESSAGE(!original.finish(begun.outputs), note);
    while (!branch.done()) {
        CHECK_MESSAGE(!branch.push(branch.random_counts(random, 20)), note);
        CHECK_MESSAGE(branch.exact(expected), note);
    }
    CHECK_MESSAGE(!twin.finish(branch.outputs), note);
    CHECK_MESSAGE(signals_of(branch.outputs) == expected, note);
    copy(twin, original);
    CHECK((original.finished() && original.known_until(0) == twin.known_until(0)));
}

// The one thing to check of a program that cannot fail: offline, online in any chunks, copied, and
// again after a reset, it gives what the definition gives, never twice and never late.
inline void check_all_ways(const Program& program, const Trace& trace, Random& random,
                           const std::string& note) {
    const auto expected = dense_oracle::answer(program, trace);
    CHECK_MESSAGE(!expected.undefined, note);
    std::vector<Signal> outputs;
    CHECK_MESSAGE(!offline(program, trace, outputs), note);
    CHECK_MESSAGE(outputs == expected.outputs, note);
    Executor executor(program);
    for (const std::int64_t largest : {1, 3, 20, 1000}) {
        Online online(executor, trace);
        const std::string chunks = note + ", chunks up to " + std::to_string(largest);
        while (!online.done()) {
            CHECK_MESSAGE(!online.push(online.random_counts(random, largest)), chunks);
            CHECK_MESSAGE(online.exact(expected.outputs), chunks);
        }
        CHECK_MESSAGE(!executor.finish(online.outputs), chunks);
        CHECK_MESSAGE(signals_of(online.outputs) == expected.outputs, chunks);
        CHECK(executor.known_until(0) == dense_oracle::end_of(trace));
        executor.reset();
    }
    check_copy(program, trace, random, expected.outputs, note);
}

} // namespace ways
