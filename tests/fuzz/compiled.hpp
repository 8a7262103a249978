// A compiled program of any kind, run through the C API as whoever holds a file of `rtamt compile`
// runs it: as one monitor, as a fleet, or as both.
#pragma once

#include "c_api/rtamt.h"

#include "program/crc32.hpp"
#include "program/snapshot.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace compiled {

using Bytes = std::vector<std::uint8_t>;

inline constexpr std::size_t sum_size = 4;
inline constexpr std::string_view of_fleets = "RTAMTMON";
inline constexpr std::size_t version_place = 12; // in a program of monitors of fleets

// A large state is that of a program with long windows.
inline constexpr std::size_t most_memory = std::size_t{1} << 22U;

inline void expect(bool holds) {
    if (!holds) std::abort();
}

// What is not done is refused in a sentence.
inline bool done(rtamt_status status, const char* message) {
    if (status == RTAMT_OK) return true;
    const std::string_view said = message;
    expect(!said.empty() && said.back() == '.');
    return false;
}

// Sets the checksum at the end right: else nothing that was changed would ever get past it.
inline void seal(Bytes& bytes) {
    if (bytes.size() < sum_size) return;
    const std::size_t body = bytes.size() - sum_size;
    const std::uint32_t sum = rtamt::crc32(std::span(bytes).first(body));
    std::memcpy(bytes.data() + body, &sum, sum_size);
}

// The same of a program, which becomes one for states of this version, too.
inline void seal_program(Bytes& bytes) {
    if (bytes.size() >= version_place + 2 * sum_size &&
        std::memcmp(bytes.data(), of_fleets.data(), of_fleets.size()) == 0) {
        const rtamt::Snapshot empty;
        std::memcpy(bytes.data() + version_place, empty.bytes().data(), sizeof(std::uint32_t));
    }
    seal(bytes);
}

// Small numbers, ties among them, the same in every run.
inline double value(unsigned input, unsigned sample, unsigned seed) {
    constexpr std::array<double, 8> values{0.0, 1.0, -1.0, 2.5, 4.0, 9.0, 0.5, -0.0};
    return values[(input * 5 + sample * (1 + seed % 7U) + seed) % values.size()];
}

class Single {
  public:
    explicit Single(const Bytes& program) {
        std::array<char, 300> message{};
        rtamt_monitor* made = nullptr;
        (void)done(
            rtamt_create(program.data(), program.size(), &made, message.data(), message.size()),
            message.data());
        monitor_.reset(made);
    }
    [[nodiscard]] explicit operator bool() const { return monitor_ != nullptr; }

    void run(unsigned first, unsigned count, unsigned seed) {
        const std::uint32_t inputs = rtamt_inputs(monitor_.get());
        const std::uint32_t outputs = rtamt_outputs(monitor_.get());
        if (inputs > most_inputs || outputs > most_inputs) return;
        std::vector<double> row(inputs);
        std::vector<rtamt_value> known(outputs);
        std::vector<rtamt_sample> samples(inputs);
        for (unsigned i = first; i < first + count; ++i) {
            for (std::uint32_t input = 0; input < inputs; ++input) {
                row[input] = value(input, i, seed);
                samples[input] = {std::int64_t{i} * 3 + (seed + input) % 3, row[input], input};
            }
            (void)check(rtamt_time(monitor_.get()) == RTAMT_DISCRETE
                            ? rtamt_step(monitor_.get(), row.data(), inputs, known.data(), outputs)
                            : rtamt_push(monitor_.get(), samples.data(), inputs));
            std::int64_t until = 0;
            (void)rtamt_known_until(monitor_.get(), seed, &until);
        }
        read(outputs);
    }

    // The trace ends.
    void end() {
        if (check(rtamt_finish(monitor_.get()))) read(rtamt_outputs(monitor_.get()));
        (void)check(rtamt_reset(monitor_.get()));
    }

    [[nodiscard]] Bytes save() {
        std::size_t size = 0;
        if (!check(rtamt_save(monitor_.get(), nullptr, 0, &size)) || size > most_memory) return {};
        Bytes state(size);
        expect(check(rtamt_save(monitor_.get(), state.data(), size, &size)));
        return state;
    }
    [[nodiscard]] bool restore(const Bytes& state) {
        return check(rtamt_restore(monitor_.get(), state.data(), state.size()));
    }

  private:
    static constexpr std::uint32_t most_inputs = 1000;

    struct Destroy {
        void operator()(rtamt_monitor* monitor) const { rtamt_destroy(monitor); }
    };
    std::unique_ptr<rtamt_monitor, Destroy> monitor_;

    [[nodiscard]] bool check(rtamt_status status) const {
        return done(status, rtamt_message(monitor_.get()));
    }
    void read(std::uint32_t outputs) const { // all of it can be read
        for (std::uint32_t output = 0; output < outputs; ++output) {
            const std::int64_t* steps = nullptr;
            const double* values = nullptr;
            const std::size_t count = rtamt_last_output(monitor_.get(), output, &steps, &values);
            Bytes copy(count * (sizeof(*steps) + sizeof(*values)));
            if (count == 0) continue;
            std::memcpy(copy.data(), steps, count * sizeof(*steps));
            std::memcpy(copy.data() + count * sizeof(*steps), values, count * sizeof(*values));
        }
    }
};

class Fleet {
  public:
    explicit Fleet(Bytes program) : program_(std::move(program)) {
        std::array<char, 300> message{};
        rtamt_fleet* made = nullptr;
        (void)done(rtamt_fleet_create(program_.data(), program_.size(), capacity, 0.1, &made,
                                      message.data(), message.size()),
                   message.data());
        fleet_.reset(made);
    }
    [[nodiscard]] explicit operator bool() const { return fleet_ != nullptr; }

    void run(unsigned first, unsigned count, unsigned seed) {
        const std::uint32_t inputs = rtamt_fleet_inputs(fleet_.get());
        const std::uint32_t outputs = rtamt_fleet_outputs(fleet_.get());
        if (inputs > 1000 || outputs > 1000) return;
        std::vector<std::array<double, 2>> columns(inputs);
        std::vector<const double*> pointers(inputs);
        std::vector<rtamt_fleet_value> values(2 * std::size_t{outputs});
        for (unsigned i = first; i < first + count; ++i) {
            const std::array<std::int64_t, 2> keys{1 + i % 2, 1 + (i + seed) % 2};
            const auto time = static_cast<double>(i);
            const std::array<double, 2> times{time, time + 0.5 * (seed % 3)};
            for (unsigned input = 0; input < inputs; ++input) {
                columns[input] = {value(input, i, seed), value(input, i + 1, seed)};
                pointers[input] = columns[input].data();
            }
            (void)check(rtamt_fleet_update(fleet_.get(), keys.data(), times.data(), pointers.data(),
                                           1 + i % 2, values.data(), outputs, nullptr));
            const rtamt_fleet_row* rows = nullptr;
            const std::size_t known = rtamt_fleet_rows(fleet_.get(), &rows);
            Bytes copy(known * sizeof(*rows)); // all of it can be read
            if (known != 0) std::memcpy(copy.data(), rows, copy.size());
        }
        values.resize(rtamt_fleet_size(fleet_.get()) * outputs);
        (void)check(rtamt_fleet_watermark(fleet_.get(), first + count, values.data(), outputs));
    }

    [[nodiscard]] Bytes save() {
        std::size_t size = 0;
        if (!check(rtamt_fleet_save(fleet_.get(), nullptr, 0, &size)) || size > most_memory)
            return {};
        Bytes state(size);
        expect(check(rtamt_fleet_save(fleet_.get(), state.data(), size, &size)));
        return state;
    }
    [[nodiscard]] bool restore(const Bytes& state) {
        std::array<char, 300> message{};
        rtamt_fleet* made = nullptr;
        if (!done(rtamt_fleet_restore(program_.data(), program_.size(), state.data(), state.size(),
                                      0, 0.1, &made, message.data(), message.size()),
                  message.data())) {
            return false;
        }
        fleet_.reset(made);
        return true;
    }

  private:
    static constexpr std::size_t capacity = 3;

    struct Destroy {
        void operator()(rtamt_fleet* fleet) const { rtamt_fleet_destroy(fleet); }
    };
    Bytes program_;
    std::unique_ptr<rtamt_fleet, Destroy> fleet_;

    [[nodiscard]] bool check(rtamt_status status) const {
        return done(status, rtamt_fleet_message(fleet_.get()));
    }
};

} // namespace compiled
