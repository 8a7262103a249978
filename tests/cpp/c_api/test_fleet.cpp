// A fleet through the C API: the values of a monitor for each key, and its state.
#include "c_api/rtamt.h"

#include "handle.hpp"

#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <string>

namespace {

using c_api::Bytes;
using c_api::Handle;

struct DestroyFleet {
    void operator()(rtamt_fleet* fleet) const { rtamt_fleet_destroy(fleet); }
};
using FleetHandle = std::unique_ptr<rtamt_fleet, DestroyFleet>;

const Bytes& program() {
    static const Bytes bytes = programs::bytes_of(programs::carried());
    return bytes;
}

FleetHandle create(std::size_t capacity) {
    rtamt_fleet* fleet = nullptr;
    CHECK(rtamt_fleet_create(program().data(), program().size(), capacity, 0.1, &fleet, nullptr,
                             0) == RTAMT_OK);
    return FleetHandle(fleet);
}

Bytes save(const FleetHandle& fleet) {
    std::size_t size = 0;
    CHECK(rtamt_fleet_save(fleet.get(), nullptr, 0, &size) == RTAMT_OK);
    Bytes state(size);
    CHECK(rtamt_fleet_save(fleet.get(), state.data(), size - 1, &size) == RTAMT_REFUSED);
    CHECK(rtamt_fleet_save(fleet.get(), state.data(), size, &size) == RTAMT_OK);
    return state;
}

FleetHandle restore(const Bytes& state, rtamt_status expected = RTAMT_OK) {
    rtamt_fleet* fleet = nullptr;
    CHECK(rtamt_fleet_restore(program().data(), program().size(), state.data(), state.size(), 0,
                              0.1, &fleet, nullptr, 0) == expected);
    return FleetHandle(fleet);
}

struct Samples {
    std::vector<std::int64_t> keys;
    std::vector<double> times;
    std::vector<std::vector<double>> columns; // one an input
};

// What became known, or the status with the index that was rejected.
struct Taken {
    rtamt_status status;
    std::size_t rejected;
    std::vector<rtamt_fleet_value> values;
};

Taken take(const FleetHandle& fleet, const Samples& samples) {
    std::vector<const double*> columns;
    for (const auto& column : samples.columns)
        columns.push_back(column.data());
    Taken taken{RTAMT_OK, 0, std::vector<rtamt_fleet_value>(2 * samples.keys.size())};
    taken.status =
        rtamt_fleet_update(fleet.get(), samples.keys.data(), samples.times.data(), columns.data(),
                           samples.keys.size(), taken.values.data(), 2, &taken.rejected);
    return taken;
}

double period() {
    const Handle monitor = c_api::create(programs::carried());
    std::int64_t numerator = 0;
    std::int64_t denominator = 1;
    CHECK(rtamt_period(monitor.get(), &numerator, &denominator) == RTAMT_OK);
    return static_cast<double>(numerator) / static_cast<double>(denominator);
}

std::size_t inputs() {
    return rtamt_inputs(c_api::create(programs::carried()).get());
}

// Samples of several keys in one of many orders, each key a sample a round or two.
Samples round(unsigned seed, std::map<std::int64_t, int>& counts) {
    Samples samples;
    samples.columns.resize(inputs());
    for (unsigned i = 0; i < 100; ++i) {
        seed = seed * 1664525U + 1013904223U;
        const std::int64_t key = std::int64_t{(seed >> 8U) % 70U} * (i % 2 == 0 ? 1 : -1);
        samples.keys.push_back(key);
        samples.times.push_back(period() * counts[key]++);
        for (auto& column : samples.columns) {
            seed = seed * 1664525U + 1013904223U;
            column.push_back(1.0 + static_cast<double>((seed >> 8U) % 8U));
        }
    }
    return samples;
}

} // namespace

TEST_CASE("a fleet reports what a monitor of each key does, with its state saved in between") {
    FleetHandle fleet = create(200);
    std::map<std::int64_t, Handle> monitors;
    std::map<std::int64_t, int> counts;
    for (unsigned turn = 0; turn < 8; ++turn) {
        const Samples samples = round(turn, counts);
        const Taken taken = take(fleet, samples);
        CHECK(taken.status == RTAMT_OK);
        CHECK(taken.rejected == samples.keys.size());
        for (std::size_t i = 0; i < samples.keys.size(); ++i) {
            Handle& monitor = monitors[samples.keys[i]];
            if (!monitor) monitor = c_api::create(programs::carried());
            std::vector<double> row;
            for (const auto& column : samples.columns)
                row.push_back(column[i]);
            rtamt_value expected[2];
            CHECK(rtamt_step(monitor.get(), row.data(), row.size(), expected, 2) == RTAMT_OK);
            for (std::size_t k = 0; k < 2; ++k) {
                const rtamt_fleet_value& found = taken.values[2 * i + k];
                CHECK(found.known == expected[k].known);
                CHECK(found.value == expected[k].value);
                CHECK(found.warming == 0);
                const auto lag =
                    static_cast<double>(rtamt_lag(monitor.get(), static_cast<std::uint32_t>(k)));
                if (found.known != 0) {
                    CHECK(std::fabs(samples.times[i] - lag * period() - found.time) < 1e-9);
                }
            }
        }
        CHECK(rtamt_fleet_size(fleet.get()) == monitors.size());
        fleet = restore(save(fleet));
    }
}

TEST_CASE("a batch that is rejected changes nothing and names its sample") {
    const FleetHandle fleet = create(2);
    const std::vector<std::vector<double>> ones(inputs(), {1.0, 1.0, 1.0});
    CHECK(take(fleet, {{1, 2, 1}, {0.0, 5.0, period()}, ones}).status == RTAMT_OK);
    const Bytes before = save(fleet);
    const auto refused = [&](const Samples& samples) {
        const Taken taken = take(fleet, samples);
        CHECK(taken.status == RTAMT_REFUSED);
        const std::string message = rtamt_fleet_message(fleet.get());
        CHECK(save(fleet) == before);
        return std::to_string(taken.rejected) + ": " + message;
    };
    const double later = 5.0 + period();
    CHECK(
        refused({{2, 1, 3}, {later, 2 * period(), 0.0}, ones}) ==
        "2: Key 3 at index 2 of the batch is new, and the fleet has its 2 keys already: drop keys, "
        "or make a larger fleet.");
    CHECK(refused({{2, 2, 1}, {later, later, 0.0}, ones})
              .starts_with("1: Key 2 at index 1 of the batch has a sample at "));
    CHECK(refused({{2, 2, 1}, {later, 900.0, 0.0}, ones}).find("is not one period of") !=
          std::string::npos);
    CHECK(refused({{2, 1, 2}, {later, std::nan(""), 0.0}, ones}) ==
          "1: Key 1 at index 1 of the batch has the time nan s: give a finite number of seconds.");
    CHECK(refused({{2, 1, 2}, {later, 1.7e12, 0.0}, ones}) ==
          "1: Key 1 at index 1 of the batch has the time 1700000000000 s, which is no time in "
          "seconds: divide it, if it is in another unit.");
    auto holes = ones;
    holes.back()[1] = std::nan("");
    CHECK(refused({{2, 1, 2}, {later, 2 * period(), 0.0}, holes}).find("has NaN as '") !=
          std::string::npos);
}

TEST_CASE("keys are dropped and expire, and texts are keys of their own") {
    const FleetHandle fleet = create(9);
    const std::vector<std::vector<double>> ones(inputs(), {1.0, 1.0, 1.0});
    CHECK(take(fleet, {{1, 2, 3}, {0.0, 5.0, 9.0}, ones}).status == RTAMT_OK);
    const std::int64_t keys[] = {3, 4};
    CHECK(rtamt_fleet_drop(fleet.get(), keys, 2) == RTAMT_REFUSED);
    CHECK(rtamt_fleet_message(fleet.get()) == std::string("There is no key 4."));
    CHECK(rtamt_fleet_drop(fleet.get(), keys, 1) == RTAMT_OK);
    std::size_t dropped = 0;
    CHECK(rtamt_fleet_expire(fleet.get(), 5.0, &dropped) == RTAMT_OK);
    CHECK(dropped == 1);
    CHECK(rtamt_fleet_size(fleet.get()) == 1);
    const char* const text[] = {"a"};
    CHECK(rtamt_fleet_drop_text(fleet.get(), text, 1) == RTAMT_REFUSED);
    const double time = 0.0;
    const double one = 1.0;
    std::vector<const double*> columns(inputs(), &one);
    CHECK(rtamt_fleet_update_text(fleet.get(), text, &time, columns.data(), 1, nullptr, 0,
                                  nullptr) == RTAMT_REFUSED);
    CHECK(rtamt_fleet_drop(fleet.get(), std::vector<std::int64_t>{2}.data(), 1) == RTAMT_OK);
    CHECK(rtamt_fleet_update_text(fleet.get(), text, &time, columns.data(), 1, nullptr, 0,
                                  nullptr) == RTAMT_OK);
    CHECK(rtamt_fleet_drop_text(fleet.get(), text, 1) == RTAMT_OK);
}

TEST_CASE("texts that are not UTF-8, which no state may have, are refused as keys") {
    const double time = 0.0;
    const double one = 1.0;
    const std::vector<const double*> columns(inputs(), &one);
    const auto status = [&](const char* text) {
        const FleetHandle fleet = create(9);
        std::size_t rejected = 9;
        const rtamt_status found = rtamt_fleet_update_text(
            fleet.get(), &text, &time, columns.data(), 1, nullptr, 0, &rejected);
        CHECK(rejected == (found == RTAMT_OK ? 1 : 0));
        CHECK(rtamt_fleet_size(fleet.get()) == (found == RTAMT_OK ? 1 : 0));
        return found;
    };
    for (const char* text : {"", "a", "\xC3\xA4", "\xE2\x82\xAC", "\xED\x9F\xBF", "\xEE\x80\x80",
                             "\xF0\x9F\x98\x80", "\xF4\x8F\xBF\xBF"}) {
        INFO(text);
        CHECK(status(text) == RTAMT_OK);
    }
    for (const char* text :
         {"\xE4", "a\xFF", "\x80", "\xC0\x80", "\xC1\xBF", "\xC3", "\xC3(", "\xE0\x9F\xBF",
          "\xED\xA0\x80", "\xED\xBF\xBF", "\xE2\x82", "\xF0\x8F\xBF\xBF", "\xF4\x90\x80\x80",
          "\xF5\x80\x80\x80", "\xF8\x88\x80\x80\x80"}) {
        CHECK(status(text) == RTAMT_REFUSED);
    }
}

TEST_CASE("the index of a batch that is wrong as a whole is its number of samples") {
    const FleetHandle fleet = create(9);
    const double time = 0.0;
    const std::int64_t key = 1;
    const char* const text = "a";
    const auto rejected = [&](const rtamt_fleet_batch* batch) {
        std::size_t index = 99;
        CHECK(rtamt_fleet_take(fleet.get(), batch, nullptr, 0, &index) == RTAMT_REFUSED);
        return index;
    };
    CHECK(rejected(nullptr) == 0);
    rtamt_fleet_batch batch{7, nullptr, nullptr, &time, nullptr, nullptr, nullptr};
    CHECK(rejected(&batch) == 7); // no keys
    batch.keys = &key;
    batch.texts = &text;
    CHECK(rejected(&batch) == 7); // keys and texts
}

TEST_CASE("damaged states and null pointers are refused") {
    const FleetHandle fleet = create(9);
    Bytes state = save(fleet);
    state.back() ^= 1U;
    CHECK(restore(state, RTAMT_REFUSED) == nullptr);
    CHECK(restore({}, RTAMT_REFUSED) == nullptr);
    CHECK(rtamt_fleet_create(program().data(), program().size(), 9, 0.1, nullptr, nullptr, 0) ==
          RTAMT_REFUSED);
    rtamt_fleet* none = nullptr;
    CHECK(rtamt_fleet_create(program().data(), program().size(), 9, std::nan(""), &none, nullptr,
                             0) == RTAMT_REFUSED);
    const std::int64_t key = 1;
    rtamt_fleet_value value{};
    CHECK(rtamt_fleet_update(fleet.get(), &key, nullptr, nullptr, 1, &value, 1, nullptr) ==
          RTAMT_REFUSED);
    CHECK(rtamt_fleet_update(nullptr, &key, nullptr, nullptr, 0, nullptr, 0, nullptr) ==
          RTAMT_REFUSED);
    CHECK(rtamt_fleet_size(nullptr) == 0);
    CHECK(std::string(rtamt_fleet_message(nullptr)) == "There is no fleet: it was not created.");
    rtamt_fleet_destroy(nullptr);
}
