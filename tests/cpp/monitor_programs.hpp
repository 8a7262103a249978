// Programs of fleets with a monitor for each key, as Fleet.compile() writes them: of all modes but
// delayed always[0:2](sqrt(x) - y), of delayed verdicts everything_dense().
#pragma once

#include "fleet/monitor_program.hpp"
#include "program/snapshot.hpp"
#include "programs.hpp"

#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

namespace monitor_programs {

using programs::put;
using programs::put_text;
using rtamt::Domain;
using rtamt::early::Tick;
using Bytes = std::vector<std::uint8_t>;
using Mode = rtamt::fleet::MonitorProgram::Mode;

inline constexpr std::uint32_t none = rtamt::early::none;

inline std::uint32_t version() {
    const rtamt::Snapshot empty;
    std::uint32_t found = 0;
    std::memcpy(&found, empty.bytes().data(), sizeof found);
    return found;
}

inline void put_numbers(Bytes& bytes, std::initializer_list<std::uint32_t> numbers) {
    for (const std::uint32_t number : numbers)
        put(bytes, number);
}

inline void put_ticks(Bytes& bytes, std::initializer_list<Tick> ticks) {
    for (const Tick tick : ticks)
        put(bytes, static_cast<std::uint64_t>(tick));
}

inline void put_step(Bytes& bytes, rtamt::Opcode opcode, std::uint32_t a, std::uint32_t b) {
    put_numbers(bytes, {static_cast<std::uint32_t>(opcode), a, b});
    put(bytes, std::uint64_t{0});
}

inline void put_group(Bytes& bytes, Mode mode) {
    put_numbers(bytes, {2, 0, 1, 2}); // inputs, number of nodes
    put_numbers(bytes, {static_cast<std::uint32_t>(rtamt::early::Kind::atom), none, none});
    put_ticks(bytes, {0, 0, 0});
    put_numbers(bytes, {4});
    put_step(bytes, rtamt::Opcode::input, 0, none);
    put_step(bytes, rtamt::Opcode::sqrt, 0, none);
    put_step(bytes, rtamt::Opcode::input, 1, none);
    put_step(bytes, rtamt::Opcode::sub, 1, 2);
    put_numbers(bytes, {static_cast<std::uint32_t>(rtamt::early::Kind::least), 0, none});
    put_ticks(bytes, {0, 2, 2});
    put_numbers(bytes, {0});
    put_numbers(bytes, {1, 2}); // outputs
    const bool starts = mode != Mode::eager;
    put_numbers(bytes, {starts ? 1U : 0U});
    if (starts) {
        put_numbers(bytes, {0, 0, 2, none, none}); // a value
        put_ticks(bytes, {0});
    }
    put_numbers(bytes, {mode == Mode::causation ? 1U : 0U});
    if (mode != Mode::causation) return;
    put_numbers(bytes, {2, 0, 0, none, none}); // an atom
    put_ticks(bytes, {0, 0, 0});
    put_numbers(bytes, {none, 4, 2, 0, none}); // the least of it
    put_ticks(bytes, {0, 2, 0});
    put_numbers(bytes, {none, 1, 2, 1, 2, none, none, none});
}

// Steps of 1/2 s; x is known to lie in [-1, 100]. `lateness` in steps; -1: none.
inline Bytes program(Mode mode, Domain domain, Tick lateness = -1) {
    Bytes bytes;
    for (const char letter : rtamt::fleet::MonitorProgram::magic)
        put(bytes, static_cast<std::uint8_t>(letter));
    put(bytes, rtamt::fleet::MonitorProgram::format);
    put(bytes, static_cast<std::uint8_t>(mode));
    put(bytes, static_cast<std::uint8_t>(domain));
    put(bytes, version());
    put_ticks(bytes, {1, 2});
    put(bytes, std::bit_cast<std::uint64_t>(0.1));
    put_ticks(bytes, {lateness});
    put_numbers(bytes, {2});
    for (const char* name : {"x", "y"}) {
        const double limit = name[0] == 'x' ? 100.0 : rtamt::infinity;
        put_text(bytes, name);
        put_numbers(bytes, {0});
        put(bytes, std::bit_cast<std::uint64_t>(name[0] == 'x' ? -1.0 : -limit));
        put(bytes, std::bit_cast<std::uint64_t>(limit));
    }
    put_text(bytes, "always[0:2](sqrt(x) - y)");
    put_text(bytes, "{}");
    put_numbers(bytes, {1, 1});
    put_text(bytes, "sqrt(x)");
    if (mode == Mode::delayed) {
        const Bytes code = programs::bytes_of(programs::everything_dense());
        put_text(bytes, {code.begin(), code.end()});
        put_numbers(bytes, {0, 0});
    } else {
        put_numbers(bytes, {0, 1});
        put_group(bytes, mode);
        put_numbers(bytes, {1, 1, 0, 0});
    }
    put(bytes, std::uint32_t{0});
    return programs::sealed(std::move(bytes));
}

struct Case {
    Mode mode;
    Domain domain;
    Tick lateness = -1;

    [[nodiscard]] Bytes program() const {
        return monitor_programs::program(mode, domain, lateness);
    }
    [[nodiscard]] bool dense() const { return domain == Domain::dense; }
};

inline const std::vector<Case>& cases() {
    static const std::vector<Case> all{
        {Mode::delayed, Domain::dense},     {Mode::eager, Domain::discrete},
        {Mode::eager, Domain::dense},       {Mode::interval, Domain::discrete},
        {Mode::interval, Domain::dense},    {Mode::interval, Domain::discrete, 2},
        {Mode::interval, Domain::dense, 2}, {Mode::causation, Domain::discrete},
        {Mode::causation, Domain::dense},
    };
    return all;
}

} // namespace monitor_programs
