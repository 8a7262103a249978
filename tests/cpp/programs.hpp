// Programs for tests: a builder, and the bytes of a program as whoever compiles one writes them.
#pragma once

#include "program/crc32.hpp"
#include "program/metadata.hpp"
#include "program/program.hpp"

#include <bit>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace programs {

using rtamt::Instruction;
using rtamt::Opcode;
using rtamt::Program;

class Builder {
  public:
    std::uint32_t input() {
        return add({Opcode::input, rtamt::no_operand, rtamt::no_operand, program_.inputs++, 0, 0});
    }
    std::uint32_t constant(double x) {
        return add({Opcode::constant, rtamt::no_operand, rtamt::no_operand, 0, x, 0});
    }
    // The lag of a pointwise operation is that of its operands.
    std::uint32_t pointwise(Opcode opcode, std::uint32_t a, std::uint32_t b = rtamt::no_operand) {
        Instruction instruction{opcode, a, b, 0, 0, 0};
        instruction.lag = program_.operand_lag(instruction);
        return add(instruction);
    }
    std::uint32_t unary(Opcode opcode, std::uint32_t a, std::int64_t n, std::int64_t lag,
                        double x = 0) {
        return add({opcode, a, rtamt::no_operand, n, x, lag});
    }
    std::uint32_t binary(Opcode opcode, std::uint32_t a, std::uint32_t b, std::int64_t n,
                         std::int64_t lag) {
        return add({opcode, a, b, n, 0, lag});
    }
    std::uint32_t call(const rtamt_kernel& kernel, const rtamt_setup& setup,
                       std::vector<std::uint32_t> operands, std::int64_t lag) {
        program_.calls.push_back({&kernel, setup, std::move(operands)});
        const auto number = static_cast<std::int64_t>(program_.calls.size() - 1);
        return add({Opcode::call, rtamt::no_operand, rtamt::no_operand, number, 0, lag});
    }
    Builder& dense() {
        program_.domain = rtamt::Domain::dense;
        return *this;
    }
    // Without passes, so that every value stays in a register of its own.
    Builder& plain() {
        program_.without = 3;
        return *this;
    }
    // The same values, known `distance` slots later.
    std::uint32_t later(std::uint32_t a, std::int64_t distance) {
        return unary(Opcode::shift, a, distance, lag(a) + distance);
    }
    [[nodiscard]] std::int64_t lag(std::uint32_t a) const { return program_.instructions[a].lag; }
    Builder& output(std::uint32_t a) {
        program_.outputs.push_back(a);
        return *this;
    }
    [[nodiscard]] const Program& program() const { return program_; }

  private:
    Program program_;

    std::uint32_t add(const Instruction& instruction) {
        program_.instructions.push_back(instruction);
        return static_cast<std::uint32_t>(program_.instructions.size() - 1);
    }
};

template <class Unsigned>
void put(std::vector<std::uint8_t>& bytes, Unsigned value) {
    for (std::size_t i = 0; i < sizeof(Unsigned); ++i) {
        bytes.push_back(static_cast<std::uint8_t>(std::uint64_t{value} >> (8 * i)));
    }
}

// Sets the checksum at the end right.
inline std::vector<std::uint8_t> sealed(std::vector<std::uint8_t> bytes) {
    bytes.erase(bytes.end() - 4, bytes.end());
    put(bytes, rtamt::crc32(bytes));
    return bytes;
}

inline std::vector<std::uint8_t> bytes_of(const Program& program) {
    std::vector<std::uint8_t> bytes;
    for (const char letter : std::string("RTAMTPRG"))
        put(bytes, static_cast<std::uint8_t>(letter));
    put(bytes, std::uint16_t{1});
    put(bytes, static_cast<std::uint8_t>(program.domain));
    put(bytes, program.without);
    put(bytes, static_cast<std::uint32_t>(program.instructions.size()));
    put(bytes, program.inputs);
    put(bytes, static_cast<std::uint32_t>(program.outputs.size()));
    put(bytes, static_cast<std::uint32_t>(program.note.size()));
    put(bytes, static_cast<std::uint32_t>(program.worst_case));
    for (const Instruction& instruction : program.instructions) {
        put(bytes, static_cast<std::uint32_t>(instruction.opcode));
        put(bytes, instruction.a);
        put(bytes, instruction.b);
        put(bytes, std::uint32_t{0});
        put(bytes, static_cast<std::uint64_t>(instruction.n));
        put(bytes, std::bit_cast<std::uint64_t>(instruction.x));
        put(bytes, static_cast<std::uint64_t>(instruction.lag));
    }
    for (const std::uint32_t output : program.outputs)
        put(bytes, output);
    for (const char letter : program.note)
        put(bytes, static_cast<std::uint8_t>(letter));
    put(bytes, std::uint32_t{0});
    return sealed(std::move(bytes));
}

inline void put_text(std::vector<std::uint8_t>& bytes, const std::string& text) {
    put(bytes, static_cast<std::uint32_t>(text.size()));
    bytes.insert(bytes.end(), text.begin(), text.end());
}

// The note that metadata.hpp reads: names, steps of 1/10 s.
inline std::string note_of(const rtamt::Metadata& metadata) {
    std::vector<std::uint8_t> bytes;
    put(bytes, static_cast<std::uint64_t>(metadata.numerator));
    put(bytes, static_cast<std::uint64_t>(metadata.denominator));
    put_text(bytes, metadata.name);
    put_text(bytes, metadata.formula);
    for (const std::string& name : metadata.inputs)
        put_text(bytes, name);
    for (const std::string& name : metadata.outputs)
        put_text(bytes, name);
    put(bytes, static_cast<std::uint32_t>(metadata.parameters.size()));
    for (const rtamt::Parameter& parameter : metadata.parameters) {
        put_text(bytes, parameter.name);
        put(bytes, static_cast<std::uint32_t>(parameter.instructions.size()));
        for (const std::uint32_t instruction : parameter.instructions)
            put(bytes, instruction);
    }
    put(bytes, static_cast<std::uint32_t>(metadata.meanings.size()));
    for (const auto& [instruction, text] : metadata.meanings) {
        put(bytes, instruction);
        put_text(bytes, text);
    }
    put_text(bytes, metadata.early);
    std::vector<std::uint32_t> parameters; // Boolean ones
    std::vector<std::uint32_t> enumerated;
    for (std::uint32_t i = 0; i < metadata.parameters.size(); ++i) {
        if (metadata.parameters[i].boolean) parameters.push_back(i);
        if (!metadata.parameters[i].enumeration.name.empty()) enumerated.push_back(i);
    }
    if (metadata.booleans.empty() && parameters.empty() && enumerated.empty())
        return {bytes.begin(), bytes.end()};
    for (const std::vector<std::uint32_t>& indices : {metadata.booleans, parameters}) {
        put(bytes, static_cast<std::uint32_t>(indices.size()));
        for (const std::uint32_t index : indices)
            put(bytes, index);
    }
    if (enumerated.empty()) return {bytes.begin(), bytes.end()};
    put(bytes, static_cast<std::uint32_t>(enumerated.size()));
    for (const std::uint32_t index : enumerated) {
        const rtamt::Enumeration& enumeration = metadata.parameters[index].enumeration;
        put(bytes, index);
        put_text(bytes, enumeration.name);
        put(bytes, static_cast<std::uint32_t>(enumeration.members.size()));
        for (const auto& [name, code] : enumeration.members) {
            put_text(bytes, name);
            put(bytes, static_cast<std::uint64_t>(code));
        }
    }
    return {bytes.begin(), bytes.end()};
}

// always[0:0.3](a / b >= limit), and a / b beside it, with all that a carrier wants to know.
inline Program carried(rtamt::Domain domain = rtamt::Domain::discrete) {
    Builder builder;
    const auto a = builder.input();
    const auto b = builder.input();
    const auto limit = builder.constant(1.5);
    const auto quotient = builder.pointwise(Opcode::div, a, b);
    const auto margin = builder.pointwise(Opcode::sub, quotient, limit);
    const std::int64_t width = domain == rtamt::Domain::dense ? 3 : 4;
    builder.output(builder.unary(Opcode::slide_min, margin, width, 3)).output(quotient);
    Program program = builder.program();
    program.domain = domain;
    program.note = note_of({1,
                            10,
                            "ratio",
                            "always[0:0.3](a / b >= limit)",
                            {"a", "b"},
                            {"robustness", "ratio"},
                            {{"limit", {limit}}},
                            {{quotient, "a / b"}, {margin, "a / b - limit"}},
                            "",
                            {}});
    return program;
}

// Every kernel of discrete time with a state at once, over two inputs.
inline Program everything() {
    Builder builder;
    const auto x = builder.input();
    const auto y = builder.input();
    const auto until = builder.binary(Opcode::until, x, y, 5, 4);
    const auto window = builder.unary(Opcode::slide_max, x, 4, 3);
    const auto since = builder.binary(Opcode::since, x, y, 0, 0);
    const auto running = builder.unary(Opcode::run_min, since, 0, 0);
    const auto before = builder.unary(Opcode::shift, running, 2, 0, -9.0);
    const auto both = builder.pointwise(Opcode::min, until, builder.later(window, 1));
    const auto ratio = builder.pointwise(Opcode::div, both, builder.later(before, 4));
    builder.output(builder.unary(Opcode::slide_min, ratio, 3, 6));
    Program program = builder.program();
    program.note = note_of({1, 10, "", "everything", {"x", "y"}, {"robustness"}, {}, {}, "", {}});
    return program;
}

// Every kernel of dense time at once, over two inputs.
inline Program everything_dense() {
    Builder builder;
    const auto x = builder.input();
    const auto y = builder.input();
    const auto until = builder.binary(Opcode::until, x, y, 5, 5);
    const auto window = builder.unary(Opcode::slide_max, x, 4, 4);
    const auto late = builder.later(window, 1);
    const auto since = builder.binary(Opcode::since, x, y, 0, 0);
    const auto running = builder.unary(Opcode::run_min, since, 0, 0);
    const auto before = builder.unary(Opcode::shift, running, 2, 0, -9.0);
    const auto both = builder.pointwise(Opcode::min, until, late);
    const auto all = builder.pointwise(Opcode::add, both, builder.later(before, 5));
    builder.output(builder.pointwise(Opcode::abs, all));
    Program program = builder.program();
    program.domain = rtamt::Domain::dense;
    program.note = note_of({1, 1000, "", "everything", {"x", "y"}, {"robustness"}, {}, {}, "", {}});
    return program;
}

} // namespace programs
