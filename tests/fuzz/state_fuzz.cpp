// What libFuzzer calls: bytes that may be the state of a monitor are refused in one sentence, or
// taken over without harm, through the C API.
//
// The first byte chooses the program and how many samples come afterwards, the rest is a state,
// whose layout and checksums, its own and the program's, are set right here: else nothing that was
// changed would ever get past them, nor a corpus that is older than the layout.
#include "c_api/rtamt.h"

#include "program/crc32.hpp"
#include "programs.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace {

using rtamt::Domain;
using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t sum_place = 4; // in a state, after the number of the layout
constexpr std::size_t sum_size = 4;

struct Subject {
    Bytes program;
    Domain domain;
};

const std::array<Subject, 2>& subjects() {
    static const std::array<Subject, 2> all{
        Subject{programs::bytes_of(programs::everything()), Domain::discrete},
        Subject{programs::bytes_of(programs::everything_dense()), Domain::dense}};
    return all;
}

void expect(bool holds) {
    if (!holds) std::abort();
}

struct Destroy {
    void operator()(rtamt_monitor* monitor) const { rtamt_destroy(monitor); }
};
using Handle = std::unique_ptr<rtamt_monitor, Destroy>;

Handle create(const Bytes& program) {
    rtamt_monitor* monitor = nullptr;
    expect(rtamt_create(program.data(), program.size(), &monitor, nullptr, 0) == RTAMT_OK);
    return Handle(monitor);
}

Bytes save(rtamt_monitor* monitor) {
    std::size_t size = 0;
    expect(rtamt_save(monitor, nullptr, 0, &size) == RTAMT_OK);
    Bytes state(size);
    expect(rtamt_save(monitor, state.data(), size, &size) == RTAMT_OK);
    return state;
}

// Whatever is not taken is refused in a sentence, and changes nothing.
bool taken(const rtamt_monitor* monitor, rtamt_status status) {
    if (status == RTAMT_OK) return true;
    const std::string_view said = rtamt_message(monitor);
    expect(!said.empty() && said.back() == '.');
    return false;
}

void go_on(rtamt_monitor* monitor, Domain domain, unsigned seed) {
    for (unsigned i = 0; i < 12; ++i) {
        const double value = static_cast<double>((i * 5 + seed) % 7) - 3.0;
        if (domain == Domain::discrete) {
            const std::array<double, 2> row{value, 1.0 + i % 3};
            rtamt_value known{};
            (void)taken(monitor, rtamt_step(monitor, row.data(), row.size(), &known, 1));
        } else {
            const auto tick =
                static_cast<std::int64_t>(seed % 8) * 7 + static_cast<std::int64_t>(i) * 3;
            const std::array<rtamt_sample, 2> samples{
                rtamt_sample{tick, value, 0},
                rtamt_sample{tick + static_cast<std::int64_t>(i % 2), 1.0, 1}};
            (void)taken(monitor, rtamt_push(monitor, samples.data(), samples.size()));
        }
        std::int64_t until = 0;
        (void)rtamt_known_until(monitor, 0, &until);
    }
}

void seal(Bytes& state) {
    const std::uint32_t sum = rtamt::crc32(std::span(state).first(state.size() - sum_size));
    for (std::size_t i = 0; i < sum_size; ++i)
        state[state.size() - sum_size + i] = static_cast<std::uint8_t>(sum >> (8U * i));
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size < 1 + sum_place + 2 * sum_size) return 0;
    const unsigned seed = data[0];
    const Subject& subject = subjects()[seed % 2];
    const Handle monitor = create(subject.program);
    go_on(monitor.get(), subject.domain, seed);
    const Bytes before = save(monitor.get());
    Bytes state(data + 1, data + size);
    std::memcpy(state.data(), before.data(), sum_place);
    std::memcpy(state.data() + sum_place,
                subject.program.data() + subject.program.size() - sum_size, sum_size);
    seal(state);
    if (!taken(monitor.get(), rtamt_restore(monitor.get(), state.data(), state.size()))) {
        expect(save(monitor.get()) == before);
        return 0;
    }
    rtamt_monitor* cloned = nullptr;
    if (taken(monitor.get(), rtamt_clone(monitor.get(), &cloned))) rtamt_destroy(cloned);
    go_on(monitor.get(), subject.domain, seed / 2);
    const Bytes later = save(monitor.get());
    expect(rtamt_restore(monitor.get(), later.data(), later.size()) == RTAMT_OK);
    if (taken(monitor.get(), rtamt_finish(monitor.get()))) {
        const std::int64_t* steps = nullptr;
        const double* values = nullptr;
        const std::size_t count = rtamt_last_output(monitor.get(), 0, &steps, &values);
        Bytes output(count * (sizeof(*steps) + sizeof(*values))); // all of it can be read
        if (count != 0) {
            std::memcpy(output.data(), steps, count * sizeof(*steps));
            std::memcpy(output.data() + count * sizeof(*steps), values, count * sizeof(*values));
        }
    }
    (void)rtamt_reset(monitor.get());
    go_on(monitor.get(), subject.domain, seed);
    return 0;
}
