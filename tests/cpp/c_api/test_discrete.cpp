#include "c_api/rtamt.h"

#include "handle.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

using c_api::Bytes;
using c_api::clone;
using c_api::create;
using c_api::Handle;
using c_api::restore;
using c_api::save;
using Row = std::array<double, 2>;
using Values = std::array<rtamt_value, 2>;

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

namespace {
Handle example() {
    return create(programs::carried());
}

Values step(const Handle& monitor, const Row& row) {
    Values known{};
    CHECK(rtamt_step(monitor.get(), row.data(), 2, known.data(), 2) == RTAMT_OK);
    return known;
}

double parameter(const Handle& monitor) {
    double value = 0.0;
    CHECK(rtamt_parameter_value(monitor.get(), 0, &value) == RTAMT_OK);
    return value;
}

bool same(const Values& a, const Values& b) {
    return std::ranges::equal(a, b, [](const rtamt_value& left, const rtamt_value& right) {
        return left.known == right.known && std::bit_cast<std::uint64_t>(left.value) ==
                                                std::bit_cast<std::uint64_t>(right.value);
    });
}

Values known(double a, double b) {
    return {rtamt_value{a, 1}, rtamt_value{b, 1}};
}
} // namespace

TEST_CASE("a program says what it is") {
    const Handle monitor = example();
    CHECK((rtamt_abi() == RTAMT_ABI && rtamt_time(monitor.get()) == RTAMT_DISCRETE));
    CHECK(rtamt_name(monitor.get()) == std::string("ratio"));
    CHECK(rtamt_formula(monitor.get()) == std::string("always[0:0.3](a / b >= limit)"));
    CHECK((rtamt_inputs(monitor.get()) == 2 && rtamt_outputs(monitor.get()) == 2));
    CHECK(rtamt_input(monitor.get(), 1) == std::string("b"));
    CHECK(rtamt_output(monitor.get(), 0) == std::string("robustness"));
    CHECK((rtamt_input(monitor.get(), 2) == nullptr && rtamt_output(monitor.get(), 2) == nullptr));
    CHECK((rtamt_lag(monitor.get(), 0) == 3 && rtamt_lag(monitor.get(), 1) == 0));
    CHECK((rtamt_lag(monitor.get(), 2) == -1 && rtamt_parameters(monitor.get()) == 1));
    CHECK(rtamt_parameter(monitor.get(), 0) == std::string("limit"));
    CHECK(rtamt_parameter(monitor.get(), 1) == nullptr);
    double none = 0.0;
    CHECK(rtamt_parameter_value(monitor.get(), 1, &none) == RTAMT_REFUSED);
    CHECK(rtamt_parameter_value(monitor.get(), 0, nullptr) == RTAMT_REFUSED);
    std::int64_t numerator = 0;
    std::int64_t denominator = 0;
    rtamt_period(monitor.get(), &numerator, &denominator);
    CHECK((numerator == 1 && denominator == 10));
}

TEST_CASE("what is no program is refused with a sentence cut to the room") {
    Bytes damaged = programs::bytes_of(programs::carried());
    damaged[40] ^= 1U;
    rtamt_monitor* monitor = nullptr;
    std::array<char, 200> message{};
    CHECK(rtamt_create(damaged.data(), damaged.size(), &monitor, message.data(), message.size()) ==
          RTAMT_REFUSED);
    CHECK(monitor == nullptr);
    CHECK(message.data() == std::string("This is not a program that can be run: its checksum does "
                                        "not match, so it was damaged on the way."));
    CHECK(rtamt_create(nullptr, 99, &monitor, message.data(), 21) == RTAMT_REFUSED);
    CHECK(message.data() == std::string("This is not a progra"));
    programs::Program anonymous = programs::carried();
    anonymous.note.clear();
    const Bytes bytes = programs::bytes_of(anonymous);
    CHECK(rtamt_create(bytes.data(), bytes.size(), &monitor, message.data(), message.size()) ==
          RTAMT_REFUSED);
    CHECK(message.data() == std::string("This is not a program that can be carried: it has no "
                                        "metadata, so the names of its inputs are unknown."));
    CHECK(rtamt_step(nullptr, nullptr, 0, nullptr, 0) == RTAMT_REFUSED);
    CHECK(rtamt_message(nullptr) == std::string("There is no monitor: it was not created."));
    rtamt_destroy(nullptr);
}

TEST_CASE("null pointers and wrong sizes are refused by every function") {
    using Call = std::function<rtamt_status(rtamt_monitor*)>;
    const Handle monitor = example();
    (void)step(monitor, {3.0, 1.0});
    const Bytes before = save(monitor);
    const Row row{1.0, 1.0};
    Values places{};
    std::size_t size = 0;
    std::array<std::uint8_t, 8> little{};
    const std::vector<std::pair<Call, std::string>> wrong{
        {[&](auto* self) { return rtamt_step(self, nullptr, 2, places.data(), 2); },
         "The values of the sample are null: pass the address of 2, or the number 0."},
        {[&](auto* self) { return rtamt_step(self, row.data(), 2, nullptr, 2); },
         "The places for the outputs are null: pass the address of 2, or the number 0."},
        {[&](auto* self) { return rtamt_step(self, nullptr, 0, nullptr, 0); },
         "Sample 1 has the wrong number of values: expected 2 (a, b), got 0."},
        {[&](auto* self) { return rtamt_push(self, nullptr, 1); },
         "The samples are null: pass the address of 1, or the number 0."},
        {[&](auto* self) { return rtamt_clone(self, nullptr); },
         "The place for the result is null: pass an address."},
        {[&](auto* self) { return rtamt_save(self, nullptr, 0, nullptr); },
         "The place for the result is null: pass an address."},
        {[&](auto* self) { return rtamt_save(self, little.data(), little.size(), &size); },
         "The state takes " + std::to_string(before.size()) +
             " bytes, and there is room for 8: make room for all of them."},
        {[&](auto* self) { return rtamt_restore(self, nullptr, 9); },
         "This is not a state of a monitor, or it was damaged on the way."},
    };
    for (const auto& [call, sentence] : wrong) {
        CHECK(call(monitor.get()) == RTAMT_REFUSED);
        CHECK(rtamt_message(monitor.get()) == sentence);
        CHECK(call(nullptr) == RTAMT_REFUSED);
        CHECK(save(monitor) == before);
    }
    CHECK((size == before.size() && little == decltype(little){}));
    const std::vector<Call> without{
        [](auto* self) { return rtamt_failure(self, nullptr, nullptr); },
        [](auto* self) { return rtamt_period(self, nullptr, nullptr); },
        [&](auto* self) { return rtamt_step(self, row.data(), 2, nullptr, 0); },
        [](auto* self) { return rtamt_finish(self); },
        [](auto* self) { return rtamt_reset(self); },
        [](auto* self) { return rtamt_set_parameter(self, 0, 1.0); },
        [](auto* self) { return rtamt_set_parameter_by_name(self, "limit", 1.0); },
    };
    for (const Call& call : without)
        CHECK((call(monitor.get()) == RTAMT_OK && call(nullptr) == RTAMT_REFUSED));
    CHECK((rtamt_time(nullptr) == RTAMT_NO_DOMAIN && rtamt_sample_count(nullptr) == -1));
    CHECK((rtamt_name(nullptr) == nullptr && rtamt_formula(nullptr) == nullptr));
    CHECK((rtamt_inputs(nullptr) == 0 && rtamt_input(nullptr, 0) == nullptr));
    CHECK((rtamt_outputs(nullptr) == 0 && rtamt_output(nullptr, 0) == nullptr));
    CHECK((rtamt_parameters(nullptr) == 0 && rtamt_parameter(nullptr, 0) == nullptr));
    CHECK((rtamt_lag(nullptr, 0) == -1 &&
           rtamt_parameter_value(nullptr, 0, nullptr) == RTAMT_REFUSED));
    CHECK(rtamt_last_output(nullptr, 0, nullptr, nullptr) == 0);
    CHECK(rtamt_last_output(monitor.get(), 0, nullptr, nullptr) == 0);
    CHECK(rtamt_known_until(nullptr, 0, nullptr) == -1);
    CHECK(rtamt_known_until(monitor.get(), 0, nullptr) == 0);
    std::array<char, 99> message{};
    CHECK(rtamt_create(nullptr, 0, nullptr, message.data(), message.size()) == RTAMT_REFUSED);
    CHECK(message.data() == std::string("The place for the result is null: pass an address."));
}

TEST_CASE("samples in robustness out") {
    const Handle monitor = example();
    for (int i = 0; i < 3; ++i)
        CHECK(step(monitor, {3.0 + i, 1.0})[0].known == 0);
    CHECK(same(step(monitor, {9.0, 1.0}), known(1.5, 9.0)));
    CHECK(same(step(monitor, {9.0, 1.0}), known(2.5, 9.0)));
    std::int64_t until = 0;
    CHECK((rtamt_known_until(monitor.get(), 0, &until) == 1 && until == 1));
    CHECK(rtamt_sample_count(monitor.get()) == 5);
    CHECK(rtamt_finish(monitor.get()) == RTAMT_OK);
    const std::int64_t* steps = nullptr;
    const double* values = nullptr;
    CHECK(rtamt_last_output(monitor.get(), 0, &steps, &values) == 3);
    CHECK((steps[0] == 2 && values[0] == 3.5 && steps[2] == 4 && values[2] == 7.5));
    CHECK(rtamt_last_output(monitor.get(), 2, &steps, &values) == 0);
    CHECK(rtamt_finish(monitor.get()) == RTAMT_REFUSED);
    CHECK(rtamt_message(monitor.get()) ==
          std::string("The trace has been finished before: reset the monitor."));
    const Row row{1.0, 1.0};
    CHECK(rtamt_step(monitor.get(), row.data(), 2, nullptr, 0) == RTAMT_REFUSED);
    CHECK(rtamt_message(monitor.get()) ==
          std::string("The trace has ended: reset the monitor before the next sample."));
    rtamt_reset(monitor.get());
    CHECK((rtamt_known_until(monitor.get(), 0, &until) == 0 &&
           rtamt_sample_count(monitor.get()) == 0));
    CHECK(step(monitor, row)[0].known == 0);
}

TEST_CASE("a refused sample leaves the monitor as it was") {
    const Handle monitor = example();
    (void)step(monitor, {3.0, 1.0});
    const Bytes before = save(monitor);
    const auto refused = [&](std::span<const double> row, std::size_t outputs) {
        Values known{};
        const rtamt_status status =
            rtamt_step(monitor.get(), row.data(), row.size(), known.data(), outputs);
        CHECK((status != RTAMT_OK && save(monitor) == before));
        return std::string(rtamt_message(monitor.get()));
    };
    // Saving has its own message; the one of the step is what was said before it.
    Values known{};
    const Row bad{not_a_number, 1.0};
    CHECK(rtamt_step(monitor.get(), bad.data(), 2, known.data(), 2) == RTAMT_REFUSED);
    CHECK(rtamt_message(monitor.get()) ==
          std::string("'a' is NaN at sample 1, time 0.1 s: fill the gap or leave the sample out."));
    (void)refused(bad, 2);
    const std::array<double, 3> wide{1.0, 2.0, 3.0};
    CHECK(refused(wide, 2) == "Sample 1 has the wrong number of values: expected 2 (a, b), got 3.");
    CHECK(refused(Row{1.0, 1.0}, 3) == "The program has 2 outputs, not 3.");
    CHECK(refused(Row{0.0, 0.0}, 2) ==
          "'a / b' has no value at sample 1, time 0.1 s: it is 0/0, inf - inf, 0 * inf, or a "
          "function outside its domain; change the formula or the data so that this cannot "
          "happen.");
    const Row zero{0.0, 0.0};
    CHECK(rtamt_step(monitor.get(), zero.data(), 2, known.data(), 2) == RTAMT_UNDEFINED);
    std::uint32_t instruction = 0;
    std::int64_t sample = 0;
    rtamt_failure(monitor.get(), &instruction, &sample);
    CHECK((instruction == 3 && sample == 1));
    const rtamt_sample dense{0, 1.0, 0};
    CHECK(rtamt_push(monitor.get(), &dense, 1) == RTAMT_REFUSED);
    CHECK(rtamt_message(monitor.get()) ==
          std::string("The program is for discrete time: use rtamt_step."));
    CHECK(save(monitor) == before);
}

TEST_CASE("parameters are set before the first sample") {
    const Handle monitor = example();
    CHECK(parameter(monitor) == 1.5);
    CHECK(rtamt_set_parameter(monitor.get(), 0, 2.0) == RTAMT_OK);
    CHECK(parameter(monitor) == 2.0);
    for (int i = 0; i < 3; ++i)
        (void)step(monitor, {5.0, 1.0});
    CHECK(step(monitor, {5.0, 1.0})[0].value == 3.0);
    const auto refusal = [&](std::uint32_t parameter, double value) {
        CHECK(rtamt_set_parameter(monitor.get(), parameter, value) == RTAMT_REFUSED);
        return std::string(rtamt_message(monitor.get()));
    };
    CHECK(refusal(0, 1.0) == "The parameter 'limit' cannot change in the middle of a trace: set it "
                             "before the first sample.");
    CHECK(refusal(0, not_a_number) == "The parameter 'limit' may not be NaN.");
    CHECK(refusal(1, 0.0) == "There is no parameter 1: the program has 1.");
    rtamt_reset(monitor.get());
    CHECK(parameter(monitor) == 2.0);
    CHECK(rtamt_set_parameter(monitor.get(), 0, 1.0) == RTAMT_OK);
}

TEST_CASE("an enumerated parameter is set to the code of a member") {
    programs::Program program = programs::carried();
    rtamt::Metadata metadata = rtamt::Metadata::parse(program);
    rtamt::Enumeration& mode = metadata.parameters[0].enumeration;
    mode = {"Mode", {{"MANUAL", 0}, {"HOLD", 2}, {"AUTO", 4}}};
    const auto answer = [&](double value) {
        program.note = programs::note_of(metadata);
        const Handle monitor = create(program);
        if (rtamt_set_parameter(monitor.get(), 0, value) == RTAMT_OK) {
            CHECK(parameter(monitor) == value);
            return std::string();
        }
        CHECK(parameter(monitor) == 1.5);
        return std::string(rtamt_message(monitor.get()));
    };
    for (const double code : {0.0, 2.0, 4.0})
        CHECK(answer(code).empty());
    CHECK(answer(7.0) == "The parameter 'limit' is 7, and declared as Mode: give 0 (MANUAL), "
                         "2 (HOLD) or 4 (AUTO).");
    CHECK(answer(0.5).starts_with("The parameter 'limit' is 0.5, and declared as Mode: "));
    CHECK(answer(std::numeric_limits<double>::infinity())
              .starts_with("The parameter 'limit' is inf, and declared as Mode: "));
    CHECK(answer(not_a_number) == "The parameter 'limit' may not be NaN.");
    mode.members = {{"ONLY", -3}};
    CHECK(answer(-3.0).empty());
    CHECK(answer(3.0) == "The parameter 'limit' is 3, and declared as Mode: give -3 (ONLY).");
    mode.members.clear();
    for (int code = 0; code < 14; ++code)
        mode.members.push_back({"m" + std::to_string(code), code});
    CHECK(answer(13.0).empty());
    CHECK(answer(14.0).ends_with(", 10 (m10), 11 (m11) or one of 2 more."));
}

TEST_CASE("parameters are set by name") {
    const Handle monitor = example();
    CHECK(rtamt_set_parameter_by_name(monitor.get(), "limit", 2.0) == RTAMT_OK);
    CHECK(parameter(monitor) == 2.0);
    const auto refusal = [&](const char* name) {
        CHECK(rtamt_set_parameter_by_name(monitor.get(), name, 1.0) == RTAMT_REFUSED);
        return std::string(rtamt_message(monitor.get()));
    };
    CHECK(refusal("limt") == "There is no parameter 'limt': the program has limit.");
    CHECK(refusal(nullptr) == "The name of the parameter is null.");
    CHECK(parameter(monitor) == 2.0);
}

TEST_CASE("a state is saved restored and cloned anywhere in a trace") {
    const auto row = [](int i) { return Row{static_cast<double>(i * 7 % 5), 1.0 + i % 3}; };
    for (int cut = 0; cut < 12; ++cut) {
        const Handle monitor = example();
        CHECK(rtamt_set_parameter(monitor.get(), 0, 0.25) == RTAMT_OK);
        for (int i = 0; i < cut; ++i)
            (void)step(monitor, row(i));
        const Bytes state = save(monitor);
        const Handle other = example();
        (void)step(other, {9.0, 9.0});
        CHECK(restore(other, state) == RTAMT_OK);
        const Handle copy = clone(monitor);
        CHECK((parameter(other) == 0.25 && save(other) == state));
        CHECK(save(copy) == state);
        for (int i = cut; i < 20; ++i) {
            const Values expected = step(monitor, row(i));
            CHECK((same(step(other, row(i)), expected) && same(step(copy, row(i)), expected)));
        }
        CHECK(restore(monitor, state) == RTAMT_OK);
        CHECK(save(monitor) == state);
    }
}

TEST_CASE("no damaged state is restored") {
    const Handle monitor = example();
    for (int i = 0; i < 6; ++i)
        (void)step(monitor, {5.0 + i, 2.0});
    const Bytes state = save(monitor);
    const Handle other = example();
    (void)step(other, {1.0, 4.0});
    const Bytes before = save(other);
    for (std::size_t bit = 0; bit < 8 * state.size(); ++bit) {
        Bytes damaged = state;
        damaged[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
        CHECK(rtamt_restore(other.get(), damaged.data(), damaged.size()) == RTAMT_REFUSED);
    }
    CHECK(rtamt_message(other.get()) ==
          std::string("This is not a state of a monitor, or it was damaged on the way."));
    for (std::size_t size = 0; size < state.size(); ++size)
        CHECK(rtamt_restore(other.get(), state.data(), size) == RTAMT_REFUSED);
    programs::Program program = programs::carried();
    program.instructions[2].x = 7.0;
    const Handle stranger = create(program);
    CHECK(rtamt_restore(stranger.get(), state.data(), state.size()) == RTAMT_REFUSED);
    CHECK(rtamt_message(stranger.get()) ==
          std::string("This is the state of a monitor of another program."));
    CHECK(save(other) == before);
}

TEST_CASE("a forged state with a right checksum is refused or does no harm") {
    const auto run = [](const Handle& monitor, int from, int to) {
        for (int i = from; i < to; ++i) {
            const Row row{static_cast<double>(i * 5 % 7) - 3.0, 1.0 + i % 3};
            rtamt_value known{};
            (void)rtamt_step(monitor.get(), row.data(), 2, &known, 1);
        }
    };
    c_api::check_forged(
        programs::everything(), {0, 1, 4, 6, 11, 12},
        [&](const Handle& monitor, int cut) { run(monitor, 0, cut); },
        [&](const Handle& monitor, int cut) { run(monitor, cut, cut + 9); });
}
