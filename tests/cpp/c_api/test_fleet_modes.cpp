// Fleets of all modes through the C API: batches, keys and states, and what is wrong with any of
// them. Whether the reports are right is a law of tests/laws, against the monitors of Python.
#include "c_api/rtamt.h"

#include "check.hpp"
#include "monitor_programs.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <string_view>

namespace {

using monitor_programs::Bytes;
using monitor_programs::Case;
using monitor_programs::Mode;
using rtamt::Domain;

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

struct DestroyFleet {
    void operator()(rtamt_fleet* fleet) const { rtamt_fleet_destroy(fleet); }
};
using FleetHandle = std::unique_ptr<rtamt_fleet, DestroyFleet>;

FleetHandle create(const Case& made, std::size_t capacity = 9) {
    const Bytes program = made.program();
    rtamt_fleet* fleet = nullptr;
    std::array<char, 200> message{};
    const rtamt_status status = rtamt_fleet_create(program.data(), program.size(), capacity, 0.1,
                                                   &fleet, message.data(), message.size());
    INFO(message.data());
    CHECK(status == RTAMT_OK);
    return FleetHandle(fleet);
}

Bytes save(const FleetHandle& fleet) {
    std::size_t size = 0;
    CHECK(rtamt_fleet_save(fleet.get(), nullptr, 0, &size) == RTAMT_OK);
    Bytes state(size);
    CHECK(rtamt_fleet_save(fleet.get(), state.data(), size, &size) == RTAMT_OK);
    CHECK(size == state.size());
    return state;
}

FleetHandle restore(const Case& made, const Bytes& state, std::string* why = nullptr) {
    const Bytes program = made.program();
    rtamt_fleet* fleet = nullptr;
    std::array<char, 200> message{};
    const rtamt_status status =
        rtamt_fleet_restore(program.data(), program.size(), state.data(), state.size(), 0, 0.1,
                            &fleet, message.data(), message.size());
    CHECK((status == RTAMT_OK) == (fleet != nullptr));
    if (fleet == nullptr) CHECK(std::string_view(message.data()).ends_with('.'));
    if (why != nullptr) *why = message.data();
    return FleetHandle(fleet);
}

struct Taken {
    rtamt_status status;
    std::size_t rejected;
    std::string sentence;
};

Taken take(const FleetHandle& fleet, const std::vector<std::int64_t>& keys,
           const std::vector<double>& times, const std::vector<double>& x) {
    const std::vector<double> y(keys.size(), 1.0);
    const std::array<const double*, 2> columns{x.data(), y.data()};
    const std::size_t outputs = rtamt_fleet_outputs(fleet.get());
    std::vector<rtamt_fleet_value> values(keys.size() * outputs);
    std::size_t rejected = 0;
    const rtamt_status status =
        rtamt_fleet_update(fleet.get(), keys.data(), times.data(), columns.data(), keys.size(),
                           values.data(), outputs, &rejected);
    return {status, rejected, rtamt_fleet_message(fleet.get())};
}

// Samples that come whatever the fleet has behind it; all of them may be wrong.
void go_on(const FleetHandle& fleet, double from) {
    for (int i = 0; i < 6; ++i) {
        const double time = from + 0.5 * i;
        (void)take(fleet, {1, 2}, {time, time}, {4.0 + i, 9.0 - i});
        const rtamt_fleet_row* rows = nullptr;
        const std::size_t count = rtamt_fleet_rows(fleet.get(), &rows);
        double sum = 0;
        for (std::size_t k = 0; k < count; ++k)
            sum += rows[k].begin; // all can be read
        CHECK((std::isnan(sum) || !std::isnan(sum)));
    }
    (void)rtamt_fleet_watermark(fleet.get(), from, nullptr, 0);
}

} // namespace

TEST_CASE("a fleet of each mode tells what it is") {
    for (const Case& made : monitor_programs::cases()) {
        const FleetHandle fleet = create(made);
        CHECK(rtamt_fleet_mode(fleet.get()) == static_cast<rtamt_mode>(made.mode));
        CHECK(rtamt_fleet_time(fleet.get()) == (made.dense() ? RTAMT_DENSE : RTAMT_DISCRETE));
        CHECK(rtamt_fleet_inputs(fleet.get()) == 2);
        CHECK(std::string(rtamt_fleet_input(fleet.get(), 1)) == "y");
        CHECK(rtamt_fleet_input(fleet.get(), 2) == nullptr);
        const bool at_start = made.mode == Mode::interval || made.mode == Mode::causation;
        CHECK(rtamt_fleet_outputs(fleet.get()) == (at_start ? 2 : 0));
        CHECK((rtamt_fleet_output(fleet.get(), 0) != nullptr) == at_start);
    }
    CHECK((rtamt_fleet_mode(nullptr) == RTAMT_NO_MODE &&
           rtamt_fleet_time(nullptr) == RTAMT_NO_DOMAIN && rtamt_fleet_inputs(nullptr) == 0 &&
           rtamt_fleet_outputs(nullptr) == 0 && rtamt_fleet_input(nullptr, 0) == nullptr &&
           rtamt_fleet_output(nullptr, 0) == nullptr && rtamt_fleet_rows(nullptr, nullptr) == 0 &&
           rtamt_fleet_late(nullptr) == 0 && rtamt_fleet_is_late(nullptr, 0) == 0 &&
           rtamt_fleet_key(nullptr, 0, nullptr, nullptr) == 0));
}

TEST_CASE("a batch without samples is taken, whatever the keys are") {
    for (const Case& made : monitor_programs::cases()) {
        const FleetHandle fleet = create(made);
        CHECK(take(fleet, {7}, {0.0}, {4.0}).status == RTAMT_OK);
        const Bytes before = save(fleet);
        CHECK(rtamt_fleet_update_text(fleet.get(), nullptr, nullptr, nullptr, 0, nullptr, 0,
                                      nullptr) == RTAMT_OK);
        CHECK(rtamt_fleet_rows(fleet.get(), nullptr) == 0);
        CHECK(save(fleet) == before);
    }
}

TEST_CASE("verdicts come as rows, with the sample that made them known") {
    const FleetHandle fleet = create({Mode::eager, Domain::discrete});
    CHECK(take(fleet, {7, 8, 7}, {0.0, 5.0, 0.5}, {4.0, 0.0, 4.0}).status == RTAMT_OK);
    const rtamt_fleet_row* rows = nullptr;
    CHECK(rtamt_fleet_rows(fleet.get(), &rows) == 1);
    CHECK((rows[0].index == 1 && rows[0].begin == 5.0 && rows[0].end == 5.0 &&
           rows[0].decided_at == 5.0 && rows[0].upper == -rtamt::infinity &&
           rows[0].is_final == 1));
    CHECK(take(fleet, {7}, {1.0}, {4.0}).status == RTAMT_OK);
    CHECK(rtamt_fleet_rows(fleet.get(), &rows) == 1);
    CHECK((rows[0].begin == 0.0 && rows[0].lower == rtamt::infinity && rows[0].decided_at == 1.0));
}

TEST_CASE("bounds at the start are outputs, and a late sample leaves them as they were") {
    const FleetHandle fleet = create({Mode::interval, Domain::dense, 2});
    const std::array<std::int64_t, 3> keys{7, 7, 7};
    const std::array<double, 3> times{0.0, 4.0, 1.0};
    const std::array<double, 3> x{16.0, 9.0, 4.0};
    const std::array<const double*, 2> columns{x.data(), x.data()};
    std::array<rtamt_fleet_value, 6> values{};
    CHECK(rtamt_fleet_update(fleet.get(), keys.data(), times.data(), columns.data(), 3,
                             values.data(), 2, nullptr) == RTAMT_OK);
    CHECK((values[3].known == 1 && values[2].value <= values[3].value));
    CHECK((values[4].known == 1 && values[4].value == values[2].value));
    CHECK((values[5].known == 1 && values[5].value == values[3].value));
    CHECK(rtamt_fleet_late(fleet.get()) == 1);
    CHECK((rtamt_fleet_is_late(fleet.get(), 1) == 0 && rtamt_fleet_is_late(fleet.get(), 2) == 1));
    CHECK(rtamt_fleet_is_late(fleet.get(), 3) == 0);
}

TEST_CASE("a batch that is wrong changes nothing and names its sample") {
    for (const Case& made : monitor_programs::cases()) {
        const FleetHandle fleet = create(made, 2);
        CHECK(take(fleet, {1}, {0.0}, {4.0}).status == RTAMT_OK);
        const Bytes before = save(fleet);
        const auto refused = [&](const std::vector<std::int64_t>& keys,
                                 const std::vector<double>& times, const std::vector<double>& x,
                                 const char* part, rtamt_status status = RTAMT_REFUSED) {
            const Taken wrong = take(fleet, keys, times, x);
            INFO(wrong.sentence);
            CHECK((wrong.status == status && wrong.rejected == keys.size() - 1));
            CHECK(wrong.sentence.find(part) != std::string::npos);
            CHECK(wrong.sentence.find(" at index " + std::to_string(wrong.rejected) +
                                      " of the batch has ") != std::string::npos);
            CHECK((save(fleet) == before && rtamt_fleet_size(fleet.get()) == 1));
        };
        refused({2, 1}, {0.0, 0.5}, {1.0, not_a_number},
                "has NaN as 'x' at 0.5 s: leave the sample out.");
        refused({2, 1}, {0.0, not_a_number}, {1.0, 1.0}, "give a finite number of seconds.");
        refused({2, 1}, {0.0, 1e300}, {1.0, 1.0}, "which is no time in seconds");
        if (made.mode != Mode::delayed) {
            refused({2, 1}, {0.0, 0.5}, {1.0, 200.0}, "outside its declared range [-1, 100]");
            if (made.lateness < 0) {
                refused({2, 2, 1}, {0.0, 0.5, 0.5}, {1.0, 1.0, -1.0},
                        "has no value of 'sqrt(x)' at ", RTAMT_UNDEFINED);
            }
        }
        if (made.lateness < 0) {
            refused({2, 1}, {0.0, 0.0}, {1.0, 1.0}, "which is not after the one at 0 s.");
        }
        if (!made.dense() && made.lateness < 0) {
            refused({2, 1}, {0.0, 0.7}, {1.0, 1.0}, "which is not one period of 0.5 s after");
        }
        const Taken full = take(fleet, {2, 3}, {0.0, 0.0}, {1.0, 1.0});
        CHECK(full.sentence == "Key 3 at index 1 of the batch is new, and the fleet has its 2 keys "
                               "already: drop keys, or make a larger fleet.");
        CHECK(save(fleet) == before);
    }
}

TEST_CASE("values may be missing or bounds where the mode takes them") {
    const std::array<std::int64_t, 1> key{1};
    const std::array<double, 1> time{0.0};
    const std::array<double, 1> low{4.0};
    const std::array<double, 1> high{9.0};
    const std::array<std::uint8_t, 1> absent{0};
    const std::array<const double*, 2> columns{low.data(), low.data()};
    const std::array<const double*, 2> uppers{high.data(), nullptr};
    const std::array<const std::uint8_t*, 2> given{nullptr, absent.data()};
    for (const Case& made : monitor_programs::cases()) {
        const bool uncertain = made.mode == Mode::eager || made.mode == Mode::interval;
        const FleetHandle fleet = create(made);
        rtamt_fleet_batch batch{1,       key.data(), nullptr, time.data(), columns.data(),
                                nullptr, nullptr};
        batch.uppers = uppers.data();
        CHECK((rtamt_fleet_take(fleet.get(), &batch, nullptr, 0, nullptr) == RTAMT_OK) ==
              uncertain);
        const FleetHandle other = create(made);
        batch.uppers = nullptr;
        batch.given = given.data();
        CHECK((rtamt_fleet_take(other.get(), &batch, nullptr, 0, nullptr) == RTAMT_OK) ==
              (uncertain || made.dense()));
        batch.texts = nullptr;
        const std::array<const char*, 1> text{"a"};
        batch.texts = text.data();
        CHECK(rtamt_fleet_take(other.get(), &batch, nullptr, 0, nullptr) == RTAMT_REFUSED);
        CHECK(std::string(rtamt_fleet_message(other.get())) ==
              "The batch has keys and texts: give one of them.");
        CHECK(rtamt_fleet_take(other.get(), nullptr, nullptr, 0, nullptr) == RTAMT_REFUSED);
        batch = {1, key.data(), nullptr, nullptr, columns.data(), nullptr, nullptr};
        CHECK(rtamt_fleet_take(other.get(), &batch, nullptr, 0, nullptr) == RTAMT_REFUSED);
        batch = {1, key.data(), nullptr, time.data(), nullptr, nullptr, nullptr};
        CHECK(rtamt_fleet_take(other.get(), &batch, nullptr, 0, nullptr) == RTAMT_REFUSED);
    }
}

TEST_CASE("keys come and go, and texts are keys of their own") {
    const FleetHandle fleet = create({Mode::causation, Domain::discrete});
    CHECK(take(fleet, {1, 2, 3}, {0.0, 50.0, 90.0}, {1.0, 1.0, 1.0}).status == RTAMT_OK);
    const std::array<std::int64_t, 2> some{2, 4};
    CHECK(rtamt_fleet_drop(fleet.get(), some.data(), 2) == RTAMT_REFUSED);
    CHECK(std::string(rtamt_fleet_message(fleet.get())) == "There is no key 4.");
    CHECK(rtamt_fleet_drop(fleet.get(), some.data(), 1) == RTAMT_OK);
    std::size_t dropped = 0;
    CHECK((rtamt_fleet_expire(fleet.get(), 10.0, &dropped) == RTAMT_OK && dropped == 1));
    std::int64_t key = 0;
    const char* text = "";
    CHECK(rtamt_fleet_key(fleet.get(), 0, &key, &text) == 1);
    CHECK((key == 3 && text == nullptr && rtamt_fleet_key(fleet.get(), 1, &key, &text) == 0));
    const std::array<const char*, 1> texts{"car-1"};
    const double time = 0;
    const double x = 4;
    const std::array<const double*, 2> columns{&x, &x};
    CHECK(rtamt_fleet_update_text(fleet.get(), texts.data(), &time, columns.data(), 1, nullptr, 0,
                                  nullptr) == RTAMT_REFUSED);
    const std::int64_t last = 3;
    CHECK(rtamt_fleet_drop(fleet.get(), &last, 1) == RTAMT_OK);
    CHECK(rtamt_fleet_update_text(fleet.get(), texts.data(), &time, columns.data(), 1, nullptr, 0,
                                  nullptr) == RTAMT_OK);
    CHECK((rtamt_fleet_key(fleet.get(), 0, nullptr, &text) == 1 && std::string(text) == "car-1"));
    CHECK(rtamt_fleet_drop_text(fleet.get(), texts.data(), 1) == RTAMT_OK);
}

TEST_CASE("a watermark is for bounds, and for causation in dense time") {
    for (const Case& made : monitor_programs::cases()) {
        const bool marks = made.mode == Mode::interval ||
                           (made.mode == Mode::causation && made.domain == Domain::dense);
        const FleetHandle fleet = create(made);
        for (const double time : {not_a_number, std::numeric_limits<double>::infinity()}) {
            CHECK(rtamt_fleet_watermark(fleet.get(), time, nullptr, 0) == RTAMT_REFUSED);
            CHECK(std::string(rtamt_fleet_message(fleet.get())) ==
                  "The watermark is not finite: give a number of seconds.");
        }
        CHECK(take(fleet, {1, 2}, {0.0, 0.5}, {4.0, 9.0}).status == RTAMT_OK);
        std::array<rtamt_fleet_value, 4> values{};
        const std::size_t outputs = rtamt_fleet_outputs(fleet.get());
        CHECK((rtamt_fleet_watermark(fleet.get(), 0.0, values.data(), outputs) == RTAMT_OK) ==
              marks);
        CHECK(rtamt_fleet_watermark(fleet.get(), not_a_number, values.data(), outputs) ==
              RTAMT_REFUSED);
        if (outputs != 0) {
            CHECK(rtamt_fleet_watermark(fleet.get(), 0.0, nullptr, outputs) == RTAMT_REFUSED);
        }
        CHECK(rtamt_fleet_watermark(fleet.get(), 0.0, values.data(), 3) == RTAMT_REFUSED);
    }
}

TEST_CASE("states are those of the same program, and damaged ones are refused in a sentence") {
    for (const Case& made : monitor_programs::cases()) {
        const FleetHandle fleet = create(made);
        CHECK(take(fleet, {1, 2, 1}, {0.0, 0.0, 0.5}, {4.0, 9.0, 16.0}).status == RTAMT_OK);
        const Bytes state = save(fleet);
        const FleetHandle again = restore(made, state);
        CHECK((again != nullptr && rtamt_fleet_size(again.get()) == 2 && save(again) == state));
        go_on(again, 1.0);
        std::string why;
        for (std::size_t size = 0; size < state.size(); ++size) {
            const Bytes cut(state.begin(), state.begin() + static_cast<std::ptrdiff_t>(size));
            CHECK(restore(made, cut) == nullptr);
        }
        Bytes other = state;
        other[state.size() / 2] ^= 1U;
        CHECK(restore(made, other, &why) == nullptr);
        CHECK(why == "This is not the state of a fleet: its checksum does not match, so it was "
                     "damaged on the way.");
        const rtamt_status of_records = [&] {
            const Bytes program = programs::bytes_of(programs::carried());
            rtamt_fleet* records = nullptr;
            return rtamt_fleet_restore(program.data(), program.size(), state.data(), state.size(),
                                       0, 0.1, &records, nullptr, 0);
        }();
        CHECK(of_records == RTAMT_REFUSED);
    }
}

TEST_CASE("a program that is cut off is refused") {
    for (const Case& made : monitor_programs::cases()) {
        const Bytes whole = made.program();
        for (std::size_t size = 0; size < whole.size(); ++size) {
            rtamt_fleet* fleet = nullptr;
            CHECK(rtamt_fleet_create(whole.data(), size, 9, 0.1, &fleet, nullptr, 0) ==
                  RTAMT_REFUSED);
            CHECK(fleet == nullptr);
        }
    }
}
