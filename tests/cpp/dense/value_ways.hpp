// Runs programs in dense time over any value domain: offline, and online in chunks, some of which
// fail.
#pragma once

#include "check.hpp"
#include "dense/executor.hpp"
#include "discrete/oracle.hpp"
#include "oracle.hpp"
#include "snapshots.hpp"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace dense_ways {

using oracle::Random;
using rtamt::Program;
using rtamt::dense::BasicEventList;
using rtamt::dense::BasicEvents;
using rtamt::dense::BasicExecutor;
using rtamt::dense::Failure;

template <class Value>
struct Steps {
    std::vector<std::int64_t> times;
    std::vector<Value> values;

    [[nodiscard]] BasicEvents<Value> events(std::size_t begin, std::size_t count) const {
        return {times.data() + begin, values.data() + begin, count};
    }
};

template <class D>
using Trace = std::vector<Steps<typename D::Number::Value>>;
template <class D>
using Lists = std::vector<BasicEventList<typename D::Value>>;

// A component of step functions, without events that change nothing.
template <class Value, class Component>
dense_oracle::Signal component(const BasicEvents<Value>& events, Component&& get) {
    dense_oracle::Signal signal;
    for (std::size_t i = 0; i < events.count; ++i)
        signal.add(events.times[i], get(events.values[i]));
    return signal.merged();
}

// One trace, or one bound, of a trace.
template <class D, class Component>
Trace<rtamt::Real> component(const Trace<D>& trace, Component&& get) {
    Trace<rtamt::Real> one;
    for (const auto& steps : trace) {
        one.push_back({steps.times, {}});
        for (const auto& value : steps.values)
            one.back().values.push_back(get(value));
    }
    return one;
}

template <class D>
std::optional<Failure> offline(const Program& program, const Trace<D>& trace, Lists<D>& outputs) {
    std::vector<BasicEvents<typename D::Number::Value>> inputs;
    for (const auto& steps : trace)
        inputs.push_back(steps.events(0, steps.times.size()));
    outputs = Lists<D>(program.outputs.size());
    return BasicExecutor<D>::evaluate(program, inputs, 0, outputs);
}

template <class D>
bool equal(const Lists<D>& a, const Lists<D>& b) {
    return std::ranges::equal(a, b, [](const auto& x, const auto& y) {
        const auto left = x.view();
        const auto right = y.view();
        return std::equal(left.times, left.times + left.count, right.times,
                          right.times + right.count) &&
               std::equal(left.values, left.values + left.count, right.values,
                          right.values + right.count);
    });
}

// Online in chunks: gives what offline gives where nothing fails. A chunk that fails leaves no
// trace: a twin that never sees it, and is now and then copied from a snapshot, gives the same.
template <class D>
void check_online(const Program& program, const Trace<D>& trace, std::int64_t largest,
                  Random& random, const Lists<D>* expected, const std::string& note) {
    BasicExecutor<D> executor(program);
    auto twin = std::make_unique<BasicExecutor<D>>(program);
    Lists<D> outputs(program.outputs.size());
    Lists<D> others(program.outputs.size());
    std::vector<std::size_t> taken(trace.size(), 0);
    const auto done = [&] {
        for (std::size_t i = 0; i < trace.size(); ++i) {
            if (taken[i] != trace[i].times.size()) return false;
        }
        return true;
    };
    while (!done()) {
        std::vector<BasicEvents<typename D::Number::Value>> inputs;
        for (std::size_t i = 0; i < trace.size(); ++i) {
            const auto rest = static_cast<std::int64_t>(trace[i].times.size() - taken[i]);
            const auto count = static_cast<std::size_t>(std::min(rest, random.between(0, largest)));
            inputs.push_back(trace[i].events(taken[i], count));
            taken[i] += count;
        }
        const bool valid = !executor.push(inputs, outputs);
        CHECK_MESSAGE((valid || expected == nullptr), note);
        if (valid) CHECK_MESSAGE(!twin->push(inputs, others), note);
        if (random.chance(20)) twin = snapshots::restored(*twin, program);
    }
    const bool finished = !executor.finish(outputs);
    CHECK_MESSAGE(finished == !twin->finish(others), note);
    CHECK_MESSAGE(equal<D>(outputs, others), note);
    if (expected != nullptr) CHECK_MESSAGE((finished && equal<D>(outputs, *expected)), note);
}

} // namespace dense_ways
