#include "discrete/call.hpp"

#include "check.hpp"
#include "programs.hpp"
#include "ways.hpp"

#include <cmath>
#include <string>
#include <vector>

using oracle::Signal;
using programs::Builder;
using rtamt::Opcode;
using rtamt::Program;
using rtamt::discrete::Executor;

namespace {

// The sum of the operands `end` samples ahead, 0 where there is no such sample.
class Ahead {
  public:
    explicit Ahead(const rtamt_setup& setup) : operands_(setup.operands), wait_(setup.end) {}

    void run(const rtamt_samples& samples) {
        for (std::size_t i = 0; i < samples.count; ++i) {
            if (wait_ > 0) {
                --wait_;
                continue;
            }
            double sum = 0;
            for (std::size_t k = 0; k < operands_; ++k)
                sum += samples.operands[k][i];
            if (sum == 99) throw std::domain_error("99");
            known_.push_back(sum);
        }
        for (std::size_t i = 0; i < samples.due; ++i) {
            samples.out[i] = answered_ < known_.size() ? known_[answered_] : 0.0;
            ++answered_;
        }
    }

  private:
    std::size_t operands_;
    std::int64_t wait_;
    std::vector<double> known_;
    std::size_t answered_ = 0;
};

// once[0,2] of the sum of x, y and 1, each delayed by a sample, three samples ahead.
Program program(const rtamt_kernel& kernel) {
    Builder builder;
    const auto x = builder.later(builder.input(), 1);
    const auto y = builder.later(builder.input(), 1);
    const auto one = builder.constant(1);
    const auto call = builder.call(kernel, {0, 3, 1.0, 3}, {x, y, one}, 4);
    builder.output(builder.unary(Opcode::slide_max, call, 3, 4));
    return builder.program();
}

Signal expected(const Signal& x, const Signal& y) {
    Signal result;
    for (std::size_t t = 0; t < x.size(); ++t) {
        double most = -oracle::inf;
        for (std::size_t s = t < 2 ? 0 : t - 2; s <= t; ++s)
            most = std::max(most, s + 3 < x.size() ? x[s + 3] + y[s + 3] + 1 : 0.0);
        result.push_back(most);
    }
    return result;
}

const rtamt_kernel ahead = rtamt::KernelOf<Ahead>::table();

} // namespace

TEST_CASE("a call is like any instruction in chunks of every size") {
    oracle::Random random(7);
    for (const std::size_t size : std::initializer_list<std::size_t>{1, 3, 4, 20, 700}) {
        const Signal x = random.signal(size, 5);
        const Signal y = random.signal(size, 5);
        // Its first sample is one late: the operands are absent before that.
        Signal late(size);
        for (const std::size_t chunk : std::initializer_list<std::size_t>{1, 3, 256, 700}) {
            Executor executor(program(ahead));
            Signal results;
            for (std::size_t begin = 0; begin < size; begin += chunk) {
                const std::size_t count = std::min(chunk, size - begin);
                auto buffers = ways::buffers_for_push(executor, count);
                CHECK(
                    !executor.push(ways::pointers({x, y}, begin), count, ways::pointers(buffers)));
                results.insert(results.end(), buffers[0].begin(), buffers[0].end());
            }
            std::vector<Signal> rest{Signal(executor.remaining(0))};
            CHECK(!executor.finish(ways::pointers(rest)));
            results.insert(results.end(), rest[0].begin(), rest[0].end());
            CHECK(results == expected(x, y));
        }
    }
}

TEST_CASE("a failed call tells why and leaves no trace") {
    Executor executor(program(ahead));
    double value = 0;
    const auto step = [&](double x) {
        const std::vector<double> row{x, 0};
        return executor.step(row.data(), value);
    };
    for (const double x : {1.0, 2.0, 3.0, 4.0, 98.0})
        CHECK((step(x) == rtamt::discrete::Outcome::silent || value == 5));
    CHECK(step(0) == rtamt::discrete::Outcome::failed); // the delayed 98 arrives, and is 99 with 1
    CHECK((executor.failure().fault.text() == "99" && executor.failure().instruction == 5));
    CHECK(step(0) == rtamt::discrete::Outcome::failed);
}

TEST_CASE("bytes alone carry no call") {
    const auto bytes = programs::bytes_of(program(ahead));
    CHECK(thrown<std::invalid_argument>([&] { (void)Program::parse(bytes); }) ==
          "This is not a program that can be run: instruction 5 (call) runs code of its own, which "
          "bytes cannot carry.");
    CHECK(Program::parse(bytes, rtamt::Domain::discrete, program(ahead).calls).calls.size() == 1);
}

TEST_CASE("a call that cannot work is refused") {
    const auto bytes = programs::bytes_of(program(ahead));
    const auto refusal = [&](auto&& spoil) {
        auto calls = program(ahead).calls;
        spoil(calls);
        return thrown<std::invalid_argument>(
            [&] { (void)Program::parse(bytes, rtamt::Domain::discrete, calls); });
    };
    const std::string start = "This is not a program that can be run: instruction 5 (call) ";
    CHECK(refusal([](auto& calls) { calls[0].operands.clear(); }) == start + "lacks an operand.");
    CHECK(refusal([](auto& calls) { calls[0].operands[0] = 9; }) ==
          start + "reads instruction 9, which is not before it.");
    CHECK(refusal([](auto& calls) { calls[0].operands[0] = 0; }) ==
          start + "mixes operands of lag 0 and 1.");
    rtamt_kernel old = ahead;
    old.version = 7;
    CHECK(refusal([&](auto& calls) { calls[0].kernel = &old; }) ==
          start + "was built for version 7 of rtamt/kernel.hpp, this core has version 1; build it "
                  "again.");
    rtamt_kernel dense = ahead;
    dense.run = nullptr;
    CHECK(refusal([&](auto& calls) { calls[0].kernel = &dense; }) ==
          start + "is for dense time, and discrete time is wanted here.");
}
