#include "c_api/rtamt.h"

#include "handle.hpp"

#include <cmath>
#include <limits>

using c_api::Bytes;
using c_api::clone;
using c_api::create;
using c_api::Handle;
using c_api::restore;
using c_api::save;
using Samples = std::vector<rtamt_sample>;

namespace {
Handle example() {
    return create(programs::carried(rtamt::Domain::dense));
}

using Points = std::vector<std::pair<std::int64_t, double>>;

Points output_of(const Handle& monitor, std::uint32_t output = 0) {
    const std::int64_t* ticks = nullptr;
    const double* values = nullptr;
    const std::size_t count = rtamt_last_output(monitor.get(), output, &ticks, &values);
    Points events;
    for (std::size_t i = 0; i < count; ++i)
        events.emplace_back(ticks[i], values[i]);
    return events;
}

Points push(const Handle& monitor, const Samples& samples) {
    CHECK(rtamt_push(monitor.get(), samples.data(), samples.size()) == RTAMT_OK);
    return output_of(monitor);
}

rtamt_sample sample(int i) {
    return {i / 2 * 2 + i % 2, static_cast<double>(i * 5 % 7) - 3.0, i % 2 == 0 ? 0U : 1U};
}
} // namespace

TEST_CASE("samples in events out") {
    const Handle monitor = example();
    CHECK(rtamt_time(monitor.get()) == RTAMT_DENSE);
    CHECK(push(monitor, {{0, 3.0, 0}, {0, 1.0, 1}}).empty());
    CHECK(output_of(monitor, 1) == Points({{0, 3.0}}));
    CHECK(push(monitor, {{5, 5.0, 0}}).empty());
    CHECK(push(monitor, {{7, 2.0, 1}, {6, 4.0, 0}}) == Points({{0, 1.5}}));
    std::int64_t until = 0;
    CHECK((rtamt_known_until(monitor.get(), 0, &until) == 1 && until == 3));
    CHECK((rtamt_known_until(monitor.get(), 2, &until) == 0 &&
           rtamt_sample_count(monitor.get()) == 0));
    CHECK(rtamt_finish(monitor.get()) == RTAMT_OK);
    CHECK(output_of(monitor) == Points({{4, 0.5}}));
    CHECK((rtamt_known_until(monitor.get(), 0, &until) == 1 && until == 7));
    rtamt_reset(monitor.get());
    CHECK((output_of(monitor).empty() && rtamt_known_until(monitor.get(), 0, &until) == 0));
}

TEST_CASE("a refused sample leaves the monitor as it was") {
    const Handle monitor = example();
    (void)push(monitor, {{0, 3.0, 0}, {0, 1.0, 1}});
    const Bytes before = save(monitor);
    const auto refusal = [&](const Samples& samples, rtamt_status expected = RTAMT_REFUSED) {
        CHECK(rtamt_push(monitor.get(), samples.data(), samples.size()) == expected);
        const std::string message = rtamt_message(monitor.get());
        CHECK(save(monitor) == before);
        return message;
    };
    CHECK(refusal({{2, 3.0, 0}, {3, std::numeric_limits<double>::quiet_NaN(), 1}}) ==
          "'b' is NaN at time 0.3 s: fill the gap or leave the sample out.");
    CHECK(refusal({{2, 3.0, 2}}) == "There is no input 2: the program has 2 (a, b).");
    CHECK(refusal({{0, 3.0, 0}}) ==
          "The time of 'a' does not increase: time 0 s comes after time 0 s.");
    CHECK(refusal({{4, 3.0, 0}, {3, 3.0, 0}}) ==
          "The time of 'a' does not increase: time 0.3 s comes after time 0.4 s.");
    CHECK(refusal({{std::numeric_limits<std::int64_t>::max(), 3.0, 0}}) ==
          "'a' has a sample at tick 9223372036854775807, too far from 0: subtract a start time, or "
          "choose a coarser resolution.");
    CHECK(refusal({{4, 0.0, 0}, {4, 0.0, 1}}, RTAMT_UNDEFINED) ==
          "'a / b' has no value at time 0.4 s: it is 0/0, inf - inf, 0 * inf, or a function "
          "outside its domain; change the formula or the data so that this cannot "
          "happen.");
    std::uint32_t instruction = 0;
    std::int64_t tick = 0;
    rtamt_failure(monitor.get(), &instruction, &tick);
    CHECK((instruction == 3 && tick == 4));
    const double value = 0.0;
    rtamt_value known{};
    CHECK(rtamt_step(monitor.get(), &value, 1, &known, 1) == RTAMT_REFUSED);
    CHECK(rtamt_message(monitor.get()) ==
          std::string("The program is for dense time: use rtamt_push."));
    CHECK(rtamt_set_parameter(monitor.get(), 0, 2.0) == RTAMT_REFUSED);
    CHECK(rtamt_finish(monitor.get()) == RTAMT_OK);
    CHECK(rtamt_push(monitor.get(), nullptr, 0) == RTAMT_REFUSED);
    CHECK(rtamt_message(monitor.get()) ==
          std::string("The trace has ended: reset the monitor before the next sample."));
}

TEST_CASE("first samples without a value leave the monitor as it was") {
    const Handle monitor = example();
    const Bytes before = save(monitor);
    const Samples samples{{5, 0.0, 0}, {5, 0.0, 1}};
    CHECK(rtamt_push(monitor.get(), samples.data(), samples.size()) == RTAMT_UNDEFINED);
    CHECK(save(monitor) == before);
    (void)push(monitor, {{7, 0.0, 0}});
    const Bytes half = save(monitor);
    const rtamt_sample undefined{7, 0.0, 1};
    CHECK(rtamt_push(monitor.get(), &undefined, 1) == RTAMT_UNDEFINED);
    CHECK(save(monitor) == half);
}

TEST_CASE("a state is saved restored and cloned anywhere in a trace") {
    for (int cut = 0; cut < 14; ++cut) {
        const Handle monitor = create(programs::everything_dense());
        for (int i = 0; i < cut; ++i)
            (void)push(monitor, {sample(i)});
        const Bytes state = save(monitor);
        const Handle other = create(programs::everything_dense());
        (void)push(other, {{-4, 9.0, 0}});
        CHECK(restore(other, state) == RTAMT_OK);
        const Handle copy = clone(monitor);
        CHECK((save(other) == state && save(copy) == state));
        for (int i = cut; i < 30; ++i) {
            const Points expected = push(monitor, {sample(i)});
            CHECK((push(other, {sample(i)}) == expected && push(copy, {sample(i)}) == expected));
        }
        for (const Handle* each : {&monitor, &other, &copy})
            CHECK(rtamt_finish(each->get()) == RTAMT_OK);
        CHECK(!output_of(monitor).empty());
        CHECK((output_of(other) == output_of(monitor) && output_of(copy) == output_of(monitor)));
    }
}

TEST_CASE("no damaged state is restored") {
    const Handle monitor = create(programs::everything_dense());
    for (int i = 0; i < 11; ++i)
        (void)push(monitor, {sample(i)});
    const Bytes state = save(monitor);
    for (std::size_t place = 0; place < state.size(); ++place) {
        Bytes damaged = state;
        damaged[place] ^= 0x40U;
        CHECK(rtamt_restore(monitor.get(), damaged.data(), damaged.size()) == RTAMT_REFUSED);
        CHECK(rtamt_restore(monitor.get(), state.data(), place) == RTAMT_REFUSED);
    }
    CHECK(save(monitor) == state);
}

TEST_CASE("a forged state with a right checksum is refused or does no harm") {
    const auto advance = [](const Handle& monitor, int cut) {
        for (int i = 0; i < cut; ++i)
            (void)push(monitor, {sample(i)});
        if (cut == 11)
            (void)push(monitor, {{20, 1.0, 0}, {23, 2.0, 0}}); // ahead of the other input
    };
    const auto go_on = [](const Handle& monitor, int cut) {
        for (int i = cut; i < cut + 9; ++i) {
            const rtamt_sample next = sample(i);
            (void)rtamt_push(monitor.get(), &next, 1);
        }
        const Samples jump{{40, 1.0, 0}, {40, -1.0, 1}};
        (void)rtamt_push(monitor.get(), jump.data(), jump.size());
        (void)output_of(monitor);
    };
    c_api::check_forged(programs::everything_dense(), {0, 1, 2, 5, 11, 12}, advance, go_on);
}
