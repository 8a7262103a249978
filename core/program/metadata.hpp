// The metadata of a program: names, the period, and the meaning of instructions.
//
// Layout of the note of a program, little endian; a text is u32 length and so many bytes of UTF-8:
//
//     i64, i64   seconds of a step, numerator and denominator: the sampling period in discrete
//                time, the length of a tick in dense time
//     text       name of the specification, may be empty
//     text       formula
//     text       of each input, its name
//     text       of each output, its name
//     u32        number of parameters; of each: text name, u32 number of instructions, and the u32
//                indices of these, constants all of them, which have the value of the parameter
//     u32        number of meanings; of each: u32 instruction, text of the formula it computes
//     u32        number of bytes that follow: the graph of bounds at the start of the trace
//                (../c_api/early_runner.hpp), or none
//     u32        number of Boolean inputs, and the u32 index of each
//     u32        number of Boolean parameters, and the u32 index of each
//     u32        number of enumerated parameters; of each: u32 index, text name of the enumeration,
//                u32 number of members, at least 1; of each: text name, i64 code
//
// Notes without enumerated parameters end before the last field, and those without Boolean inputs
// and parameters, too, before the last three.
#pragma once

#include "program.hpp"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace rtamt {

struct Enumeration {
    struct Member {
        std::string name;
        std::int64_t code = 0;
    };

    std::string name;
    std::vector<Member> members; // none: no enumeration
};

struct Parameter {
    std::string name;
    std::vector<std::uint32_t> instructions; // at least one
    bool boolean = false;                    // its value is 1 or 0
    Enumeration enumeration = {};            // if it has members, its value is the code of one
};

struct Metadata {
    std::int64_t numerator = 1;
    std::int64_t denominator = 1;
    std::string name;
    std::string formula;
    std::vector<std::string> inputs;
    std::vector<std::string> outputs;
    std::vector<Parameter> parameters;
    std::map<std::uint32_t, std::string> meanings; // by instruction
    std::string early;                             // the graph, as bytes
    std::vector<std::uint32_t> booleans;           // inputs whose values are 1 or 0

    // Reads and checks the note of a program; throws std::invalid_argument with one sentence.
    [[nodiscard]] static Metadata parse(const Program& program);

    // Seconds of a step.
    [[nodiscard]] double seconds() const noexcept {
        return static_cast<double>(numerator) / static_cast<double>(denominator);
    }
};

} // namespace rtamt
