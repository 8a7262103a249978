// Runs programs over any value domain: offline, and online in chunks, some of which fail.
#pragma once

#include "check.hpp"
#include "discrete/executor.hpp"
#include "oracle.hpp"
#include "program/program.hpp"
#include "snapshots.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace value_ways {

using oracle::Random;
using rtamt::Program;
using rtamt::discrete::BasicExecutor;
using rtamt::discrete::Failure;

// The samples of one input, as numbers and as formulas; a program reads one of them.
template <class D>
struct Samples {
    std::vector<typename D::Number::Value> numbers;
    std::vector<typename D::Value> formulas;
};

template <class D>
using Values = std::vector<typename D::Value>;

template <class D>
std::vector<typename BasicExecutor<D>::Column>
columns(const Program& program, const std::vector<Samples<D>>& samples, std::size_t offset) {
    const BasicExecutor<D> executor(program);
    std::vector<typename BasicExecutor<D>::Column> columns;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        if (executor.input_sort(i) == rtamt::Sort::number || rtamt::UniformDomain<D>) {
            columns.push_back(samples[i].numbers.data() + offset);
            continue;
        }
        if constexpr (!rtamt::UniformDomain<D>) {
            columns.push_back(samples[i].formulas.data() + offset);
        }
    }
    return columns;
}

template <class D>
std::vector<typename D::Value*> pointers(std::vector<Values<D>>& outputs) {
    std::vector<typename D::Value*> pointers;
    for (auto& output : outputs)
        pointers.push_back(output.data());
    return pointers;
}

template <class D>
std::optional<Failure> offline(const Program& program, const std::vector<Samples<D>>& samples,
                               std::size_t count, std::vector<Values<D>>& outputs) {
    outputs.assign(program.outputs.size(), Values<D>(count));
    return BasicExecutor<D>::evaluate(program, columns<D>(program, samples, 0), count,
                                      pointers<D>(outputs));
}

// Pushes samples [begin, begin + count), or finishes where there is no count; appends what became
// known.
template <class D>
bool advance(BasicExecutor<D>& executor, const std::vector<Samples<D>>& samples, std::size_t begin,
             std::optional<std::size_t> count, std::vector<Values<D>>& outputs) {
    std::vector<Values<D>> fresh;
    for (std::size_t i = 0; i < outputs.size(); ++i)
        fresh.emplace_back(count ? executor.known(i, *count) : executor.remaining(i));
    const auto targets = pointers<D>(fresh);
    const auto failure =
        count ? executor.push(columns<D>(executor.program(), samples, begin), *count, targets)
              : executor.finish(targets);
    if (failure) return false;
    for (std::size_t i = 0; i < outputs.size(); ++i)
        outputs[i].insert(outputs[i].end(), fresh[i].begin(), fresh[i].end());
    return true;
}

// Online in chunks: gives what offline gives where no chunk fails. A chunk that fails leaves no
// trace: a twin that never sees it, and is now and then copied from a snapshot, gives the same.
template <class D>
void check_online(const Program& program, const std::vector<Samples<D>>& samples, std::size_t count,
                  std::int64_t largest, Random& random, const std::vector<Values<D>>* expected,
                  const std::string& note) {
    BasicExecutor<D> executor(program);
    auto twin = std::make_unique<BasicExecutor<D>>(program);
    std::vector<Values<D>> outputs(program.outputs.size());
    std::vector<Values<D>> others(program.outputs.size());
    for (std::size_t begin = 0; begin < count;) {
        const auto chunk = std::min<std::size_t>(
            count - begin, static_cast<std::size_t>(random.between(1, largest)));
        const bool taken = advance<D>(executor, samples, begin, chunk, outputs);
        CHECK_MESSAGE((taken || expected == nullptr), note);
        if (taken) CHECK_MESSAGE(advance<D>(*twin, samples, begin, chunk, others), note);
        if (random.chance(20)) twin = snapshots::restored(*twin, program);
        begin += chunk;
    }
    const bool finished = advance<D>(executor, samples, 0, std::nullopt, outputs);
    CHECK_MESSAGE(finished == advance<D>(*twin, samples, 0, std::nullopt, others), note);
    CHECK_MESSAGE(outputs == others, note);
    if (expected != nullptr) CHECK_MESSAGE((finished && outputs == *expected), note);
}

} // namespace value_ways
