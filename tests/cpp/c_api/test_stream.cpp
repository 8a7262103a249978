// A stream through the C API: samples in any order have the results of a fleet in order.
#include "c_api/rtamt.h"

#include "handle.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <string>
#include <tuple>

namespace {

using c_api::Bytes;
using c_api::Handle;

template <class Stream, void destroy(Stream*)>
struct Destroy {
    void operator()(Stream* stream) const { destroy(stream); }
};
using Stream = std::unique_ptr<rtamt_stream, Destroy<rtamt_stream, rtamt_stream_destroy>>;
using Fleet = std::unique_ptr<rtamt_fleet, Destroy<rtamt_fleet, rtamt_fleet_destroy>>;

// Key, time of the sample, what is known of the first output, and its value.
using Row = std::tuple<std::string, double, int, double>;

const Bytes& program() {
    static const Bytes bytes = programs::bytes_of(programs::carried());
    return bytes;
}

Stream create(double lateness, rtamt_gaps gaps = RTAMT_GAPS_RESTART, std::size_t capacity = 9) {
    rtamt_stream* stream = nullptr;
    CHECK(rtamt_stream_create(program().data(), program().size(), capacity, 0.1, lateness, gaps,
                              &stream, nullptr, 0) == RTAMT_OK);
    return Stream(stream);
}

Bytes save(const Stream& stream) {
    std::size_t size = 0;
    CHECK(rtamt_stream_save(stream.get(), nullptr, 0, &size) == RTAMT_OK);
    Bytes state(size);
    CHECK(rtamt_stream_save(stream.get(), state.data(), size - 1, &size) == RTAMT_REFUSED);
    CHECK(rtamt_stream_save(stream.get(), state.data(), size, &size) == RTAMT_OK);
    return state;
}

Stream restore(const Bytes& state, std::string* message = nullptr) {
    rtamt_stream* stream = nullptr;
    char said[200] = "";
    const rtamt_status status =
        rtamt_stream_restore(program().data(), program().size(), state.data(), state.size(), 0, 0.1,
                             &stream, said, sizeof said);
    CHECK((status == RTAMT_OK) == (stream != nullptr));
    if (message != nullptr) *message = said;
    return Stream(stream);
}

double period() {
    const Handle monitor = c_api::create(programs::carried());
    std::int64_t numerator = 0;
    std::int64_t denominator = 1;
    CHECK(rtamt_period(monitor.get(), &numerator, &denominator) == RTAMT_OK);
    return static_cast<double>(numerator) / static_cast<double>(denominator);
}

// What has left, after those rows.
void append(const Stream& stream, std::size_t released, std::vector<Row>& rows) {
    for (std::size_t i = 0; i < released; ++i) {
        rtamt_stream_sample sample{};
        rtamt_fleet_value value{};
        CHECK(rtamt_stream_released(stream.get(), i, &sample, &value, 1) == RTAMT_OK);
        rows.emplace_back(sample.text == nullptr ? std::to_string(sample.key) : sample.text,
                          sample.time, value.known, value.value);
    }
    CHECK(rtamt_stream_released(stream.get(), released, nullptr, nullptr, 0) == RTAMT_REFUSED);
}

// The formula divides the one input by the other: 0 has no value.
std::vector<double> divisors_of(const std::vector<double>& values) {
    std::vector<double> divisors;
    for (const double value : values)
        divisors.push_back(value == 0.0 ? 0.0 : 2.0);
    return divisors;
}

struct Sent {
    std::string key;
    int step;
    double value;
};

// Sends samples one by one or together; returns which were late.
std::vector<std::int32_t> send(const Stream& stream, const std::vector<Sent>& sent,
                               std::vector<Row>& rows, rtamt_status expected = RTAMT_OK,
                               std::size_t* rejected = nullptr) {
    std::vector<const char*> keys;
    std::vector<double> times;
    std::vector<double> values;
    for (const Sent& each : sent) {
        keys.push_back(each.key.c_str());
        times.push_back(period() * each.step);
        values.push_back(each.value);
    }
    const std::vector<double> divisors = divisors_of(values);
    const std::vector<const double*> columns{values.data(), divisors.data()};
    std::vector<std::int32_t> late(sent.size());
    std::size_t released = 0;
    CHECK(rtamt_stream_update_text(stream.get(), keys.data(), times.data(), columns.data(),
                                   sent.size(), late.data(), &released, rejected) == expected);
    if (expected == RTAMT_OK) append(stream, released, rows);
    return late;
}

} // namespace

TEST_CASE("samples in any order have the results of a fleet in order, whatever the batches") {
    std::vector<Sent> ordered;
    for (int step = 0; step < 30; ++step)
        for (const char* key : {"a", "b", "c"})
            ordered.push_back({key, step, 1.0 + (7 * step + key[0]) % 5});
    std::vector<Sent> mixed = ordered;
    for (std::size_t i = 0; i + 9 < mixed.size(); i += 9)
        std::reverse(mixed.begin() + static_cast<std::ptrdiff_t>(i),
                     mixed.begin() + static_cast<std::ptrdiff_t>(i) + 9);
    std::map<std::string, std::vector<Row>> expected;
    for (const char* key : {"a", "b", "c"}) {
        rtamt_fleet* made = nullptr;
        CHECK(rtamt_fleet_create(program().data(), program().size(), 1, 0.1, &made, nullptr, 0) ==
              RTAMT_OK);
        const Fleet fleet(made);
        for (const Sent& each : ordered) {
            if (each.key != key) continue;
            const double time = period() * each.step;
            const double divisor = 2.0;
            const double* const columns[] = {&each.value, &divisor};
            rtamt_fleet_value value{};
            CHECK(rtamt_fleet_update_text(fleet.get(), &key, &time, columns, 1, &value, 1,
                                          nullptr) == RTAMT_OK);
            expected[key].emplace_back(key, time, value.known, value.value);
        }
    }
    for (const std::size_t size : {std::size_t{1}, std::size_t{7}, mixed.size()}) {
        Stream stream = create(4 * period());
        std::vector<Row> rows;
        for (std::size_t first = 0; first < mixed.size(); first += size) {
            const std::size_t last = std::min(first + size, mixed.size());
            const auto late = send(stream,
                                   {mixed.begin() + static_cast<std::ptrdiff_t>(first),
                                    mixed.begin() + static_cast<std::ptrdiff_t>(last)},
                                   rows);
            CHECK(std::ranges::count(late, 0) == static_cast<std::ptrdiff_t>(late.size()));
            stream = restore(save(stream));
        }
        CHECK(rtamt_stream_waiting(stream.get()) == 12);
        std::size_t released = 0;
        CHECK(rtamt_stream_watermark(stream.get(), 1e9, &released) == RTAMT_OK);
        CHECK(released == 12);
        append(stream, released, rows);
        std::map<std::string, std::vector<Row>> found;
        for (const Row& row : rows)
            found[std::get<0>(row)].push_back(row);
        CHECK(found == expected);
        CHECK(rtamt_stream_late(stream.get()) == 0);
    }
}

TEST_CASE("late samples are counted, gaps are filled, and keys come and go") {
    Stream stream = create(period(), RTAMT_GAPS_HOLD);
    std::vector<Row> rows;
    CHECK(send(stream, {{"a", 0, 1}, {"a", 3, 2}, {"a", 1, 9}, {"a", 3, 4}, {"b", 0, 5}}, rows) ==
          std::vector<std::int32_t>{0, 0, 1, 1, 0});
    CHECK(rtamt_stream_late(stream.get()) == 2);
    CHECK(rows.size() == 1);
    stream = restore(save(stream));
    CHECK(rtamt_stream_late(stream.get()) == 2);
    send(stream, {{"a", 4, 3}}, rows);
    REQUIRE(rows.size() == 4); // 1 and 2 are filled
    CHECK(std::get<1>(rows[2]) == doctest::Approx(2 * period()));
    CHECK(rtamt_stream_size(stream.get()) == 2);
    const char* const keys[] = {"b", "z"};
    CHECK(rtamt_stream_drop_text(stream.get(), keys, 2) == RTAMT_REFUSED);
    CHECK(rtamt_stream_message(stream.get()) == std::string("There is no key 'z'."));
    CHECK(rtamt_stream_drop_text(stream.get(), keys, 1) == RTAMT_OK);
    CHECK(rtamt_stream_waiting(stream.get()) == 1);
    std::size_t dropped = 0;
    CHECK(rtamt_stream_expire(stream.get(), 4.5 * period(), &dropped) == RTAMT_OK);
    CHECK(dropped == 1);
    CHECK(rtamt_stream_size(stream.get()) == 0);
    const std::int64_t number = 7;
    const double time = 0.0;
    const double one = 1.0;
    const double* const columns[] = {&one, &one};
    std::size_t released = 0;
    CHECK(rtamt_stream_update(stream.get(), &number, &time, columns, 1, nullptr, &released,
                              nullptr) == RTAMT_OK);
    CHECK(released == 0);
    CHECK(rtamt_stream_watermark(stream.get(), 0.0, &released) == RTAMT_OK);
    rows.clear();
    append(stream, released, rows);
    CHECK(std::get<0>(rows.at(0)) == "7");
    CHECK(rtamt_stream_drop(stream.get(), &number, 1) == RTAMT_OK);
}

TEST_CASE("a sample that waits and has no value fails until it is discarded") {
    const Stream stream = create(2 * period());
    std::vector<Row> rows;
    send(stream, {{"a", 0, 1}, {"a", 1, 0}, {"a", 2, 1}}, rows);
    const Bytes before = save(stream);
    for (int turn = 0; turn < 2; ++turn) {
        std::size_t rejected = 0;
        send(stream, {{"b", 0, 1}, {"a", 3, 1}}, rows, RTAMT_UNDEFINED, &rejected);
        const std::string message = rtamt_stream_message(stream.get());
        CHECK(message.starts_with("Key 'a', a sample that waited, has no value of 'a / b' at "));
        CHECK(rejected == 2);
        CHECK(save(stream) == before);
    }
    rtamt_stream_sample culprit{};
    CHECK(rtamt_stream_culprit(stream.get(), &culprit) == RTAMT_OK);
    CHECK(std::string(culprit.text) == "a");
    CHECK(culprit.time == period());
    const std::string key = culprit.text;
    CHECK(rtamt_stream_discard_text(stream.get(), key.c_str(), culprit.time) == RTAMT_OK);
    CHECK(rtamt_stream_discard_text(stream.get(), key.c_str(), period()) == RTAMT_REFUSED);
    CHECK(std::string(rtamt_stream_message(stream.get()))
              .starts_with("No sample of the key 'a' waits at "));
    rows.clear();
    send(stream, {{"b", 0, 1}, {"a", 3, 1}}, rows);
    CHECK(rtamt_stream_culprit(stream.get(), &culprit) == RTAMT_REFUSED);
    CHECK(rtamt_stream_waiting(stream.get()) == 3);
}

TEST_CASE("a sample that waited after a gap too long to be filled is named, and can be discarded") {
    const Stream stream = create(period(), RTAMT_GAPS_HOLD);
    std::vector<Row> rows;
    send(stream, {{"a", 0, 1}, {"a", 20'000, 1}}, rows);
    const Bytes before = save(stream);
    std::size_t rejected = 0;
    send(stream, {{"b", 0, 1}, {"a", 20'001, 1}}, rows, RTAMT_REFUSED, &rejected);
    CHECK(rejected == 2);
    const std::string message = rtamt_stream_message(stream.get());
    CHECK(message.starts_with("Key 'a', a sample that waited, has a sample at "));
    CHECK(message.ends_with(" s, and more than 10000 are missing after the one at 0 s: drop the "
                            "key, so that its trace begins again."));
    CHECK(save(stream) == before);
    rtamt_stream_sample culprit{};
    CHECK(rtamt_stream_culprit(stream.get(), &culprit) == RTAMT_OK);
    CHECK(std::string(culprit.text) == "a");
    CHECK(culprit.time == 20'000 * period());
    CHECK(rtamt_stream_discard_text(stream.get(), "a", culprit.time) == RTAMT_OK);
    const Stream prompt = create(0.0, RTAMT_GAPS_HOLD);
    send(prompt, {{"a", 0, 1}}, rows);
    send(prompt, {{"b", 0, 1}, {"a", 20'000, 1}}, rows, RTAMT_REFUSED, &rejected);
    CHECK(rejected == 1);
    CHECK(rtamt_stream_culprit(prompt.get(), &culprit) == RTAMT_REFUSED);
}

TEST_CASE("no sample that waited is blamed for a call without keys") {
    const Stream stream = create(2 * period());
    std::vector<Row> rows;
    send(stream, {{"a", 0, 1}, {"a", 1, 0}, {"a", 2, 1}}, rows);
    send(stream, {{"a", 3, 1}}, rows, RTAMT_UNDEFINED);
    std::size_t released = 9;
    std::size_t rejected = 9;
    CHECK(rtamt_stream_update(stream.get(), nullptr, nullptr, nullptr, 3, nullptr, &released,
                              &rejected) == RTAMT_REFUSED);
    CHECK(released == 0);
    CHECK(rejected == 3);
    CHECK(rtamt_stream_culprit(stream.get(), nullptr) == RTAMT_REFUSED);
    send(stream, {{"a", 3, 1}}, rows, RTAMT_UNDEFINED);
    const char* const none[] = {nullptr};
    released = rejected = 9;
    CHECK(rtamt_stream_update_text(stream.get(), none, nullptr, nullptr, 1, nullptr, &released,
                                   &rejected) == RTAMT_REFUSED);
    CHECK(released == 0);
    CHECK(rejected == 1);
    CHECK(rtamt_stream_culprit(stream.get(), nullptr) == RTAMT_REFUSED);
}

TEST_CASE("wrong calls are refused and change nothing") {
    const Stream stream = create(period(), RTAMT_GAPS_REJECT, 2);
    std::vector<Row> rows;
    send(stream, {{"a", 0, 1}, {"b", 0, 1}}, rows);
    const Bytes before = save(stream);
    std::size_t rejected = 0;
    const auto refused = [&](const std::vector<Sent>& sent) {
        send(stream, sent, rows, RTAMT_REFUSED, &rejected);
        const std::string message = rtamt_stream_message(stream.get());
        CHECK(save(stream) == before);
        return std::to_string(rejected) + ": " + message;
    };
    CHECK(refused({{"a", 1, 1}, {"c", 0, 1}}) ==
          "1: Key 'c' at index 1 of the batch is new, and the fleet has its 2 keys already: drop "
          "keys, or make a larger fleet.");
    CHECK(refused({{"a", 1, std::nan("")}})
              .starts_with("0: Key 'a' at index 0 of the batch has NaN as '"));
    CHECK(
        refused({{"a", 2, 1}, {"a", 4, 1}}).find("'a' at index 0 of the batch has a sample at ") !=
        std::string::npos);
    CHECK(refused({{"a", 1, 1}, {"\xE4", 1, 1}}) ==
          "1: The key at index 1 of the batch is not UTF-8: encode it, or use whole numbers.");
    const char* const keys[] = {"b", "a"};
    const double times[] = {period(), 1.7e12};
    const double ones[] = {1.0, 1.0};
    const double* const columns[] = {ones, ones};
    CHECK(rtamt_stream_update_text(stream.get(), keys, times, columns, 2, nullptr, nullptr,
                                   &rejected) == RTAMT_REFUSED);
    CHECK(rejected == 1);
    CHECK(rtamt_stream_message(stream.get()) ==
          std::string("Key 'a' at index 1 of the batch has the time 1700000000000 s, which is no "
                      "time in seconds: divide it, if it is in another unit."));
    CHECK(save(stream) == before);
    CHECK(rtamt_stream_watermark(stream.get(), std::nan(""), nullptr) == RTAMT_REFUSED);
    CHECK(rtamt_stream_update_text(stream.get(), nullptr, nullptr, nullptr, 1, nullptr, nullptr,
                                   nullptr) == RTAMT_REFUSED);
    char message[200];
    rtamt_stream* made = nullptr;
    for (const double lateness : {-1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
        CHECK(rtamt_stream_create(program().data(), program().size(), 9, 0.1, lateness,
                                  RTAMT_GAPS_HOLD, &made, message,
                                  sizeof message) == RTAMT_REFUSED);
        CHECK(message == std::string("The lateness must be a number of seconds, 0 or more."));
    }
    for (const int other : {-1, 3, 7}) {
        rtamt_gaps gaps{};
        std::memcpy(&gaps, &other, sizeof gaps);
        CHECK(rtamt_stream_create(program().data(), program().size(), 9, 0.1, 1.0, gaps, &made,
                                  message, sizeof message) == RTAMT_REFUSED);
        CHECK(message == std::string("There is no such policy for gaps."));
    }
    CHECK(rtamt_stream_size(nullptr) == 0);
    CHECK(rtamt_stream_late(nullptr) == 0);
    CHECK(rtamt_stream_save(nullptr, nullptr, 0, nullptr) == RTAMT_REFUSED);
    CHECK(rtamt_stream_message(nullptr) == std::string("There is no stream: it was not created."));
}

TEST_CASE("damaged states are refused") {
    const Stream stream = create(2 * period());
    std::vector<Row> rows;
    send(stream, {{"a", 0, 1}, {"b", 3, 1}, {"a", 2, 1}, {"a", 1, 1}, {"b", 5, 2}}, rows);
    const Bytes state = save(stream);
    for (std::size_t bit = 0; bit < 8 * state.size(); bit += 5) {
        Bytes flipped = state;
        flipped[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
        CHECK(restore(flipped) == nullptr);
    }
    for (std::size_t size = 0; size < state.size(); size += 3)
        CHECK(restore(Bytes(state.begin(), state.begin() + static_cast<std::ptrdiff_t>(size))) ==
              nullptr);
    std::string message;
    rtamt_fleet* fleet = nullptr;
    CHECK(rtamt_fleet_create(program().data(), program().size(), 2, 0.1, &fleet, nullptr, 0) ==
          RTAMT_OK);
    const Fleet held(fleet);
    std::size_t size = 0;
    CHECK(rtamt_fleet_save(fleet, nullptr, 0, &size) == RTAMT_OK);
    Bytes plain(size);
    CHECK(rtamt_fleet_save(fleet, plain.data(), size, &size) == RTAMT_OK);
    CHECK(restore(plain, &message) == nullptr);
    CHECK(message == "This is not the state of a fleet: it is no state of a fleet with lateness.");
}
