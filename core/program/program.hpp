// A program: a flat list of instructions in static single assignment form, read from bytes.
//
// Layout, little endian, version 1:
//
//     offset  type   field
//          0  8 B    magic "RTAMTPRG"
//          8  u16    version = 1
//         10  u8     time domain: 0 discrete, 1 dense
//         11  u8     passes to leave out, a bit each: 1 fuse, 2 reuse
//         12  u32    number of instructions
//         16  u32    number of inputs
//         20  u32    number of outputs
//         24  u32    length of the note
//         28  u32    options, a bit each: 1 worst case
//         32         instructions, 40 bytes each: u8 opcode, 3 B 0, u32 a, u32 b, u32 0,
//                    i64 n, f64 x, i64 lag; an operand that is not used is 0xFFFFFFFF
//                    outputs, one u32 instruction index each
//                    the note: names and meanings for users (metadata.hpp); may be empty
//                    u32 CRC-32 of everything before it
//
// An instruction with lag L yields, at slot s, the value for time (sample index) s - L. In dense
// time slots are ticks, and a window of width w is closed: it holds the last w ticks and its ends.
#pragma once

#include "opcodes.hpp"

#include <rtamt/kernel.hpp>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace rtamt {

inline constexpr std::uint32_t no_operand = 0xFFFFFFFFU;

// Widths, distances and lags in samples stay below this, so that sums of a few of them cannot
// overflow. In ticks they may be longer, and sums are guarded.
inline constexpr std::int64_t longest = 281'474'976'710'656;             // 2^48
inline constexpr std::int64_t longest_dense = 4'611'686'018'427'387'904; // 2^62

enum class Domain : std::uint8_t { discrete, dense };

// What is done with a program when it is loaded; none changes a bit of a result.
enum class Pass : std::uint8_t {
    fuse = 1,  // fusion.hpp
    reuse = 2, // liveness.hpp
};

struct Instruction {
    Opcode opcode{};
    std::uint32_t a = no_operand;
    std::uint32_t b = no_operand;
    std::int64_t n = 0; // index of an input or a call, distance of a shift, or width of a window
    double x = 0.0;     // value of a constant, or what a shift yields where there is no sample
    std::int64_t lag = 0;
    bool steady = false; // if it is a window, every sample costs the same
    bool truth = false;  // +inf or -inf wherever it is present, and so are its operands
};

// A kernel from outside the core, and the instructions that it reads. The caller that runs the
// program owns the table; it is not part of the bytes.
struct CallSite {
    const rtamt_kernel* kernel = nullptr;
    rtamt_setup setup{};
    std::vector<std::uint32_t> operands;
};

struct Program {
    std::vector<Instruction> instructions;
    std::vector<std::uint32_t> outputs;
    std::vector<CallSite> calls;
    std::uint32_t inputs = 0;
    std::string note;
    Domain domain = Domain::discrete;
    std::uint8_t without = 0; // passes to leave out
    bool worst_case = false;  // instructions are steady

    [[nodiscard]] bool applies(Pass pass) const noexcept {
        return (without & static_cast<std::uint8_t>(pass)) == 0;
    }

    // Reads and checks a serialised program for this time domain, and the calls that come with it;
    // throws std::invalid_argument with one sentence.
    [[nodiscard]] static Program parse(std::span<const std::uint8_t> bytes,
                                       Domain domain = Domain::discrete,
                                       std::vector<CallSite> calls = {});

    // Calls `visit` with the index of each operand of an instruction, in order.
    template <class Visit>
    void each_operand(const Instruction& instruction, Visit&& visit) const {
        if (instruction.opcode == Opcode::call) {
            for (const std::uint32_t operand :
                 calls[static_cast<std::size_t>(instruction.n)].operands)
                visit(operand);
            return;
        }
        if (instruction.a != no_operand) visit(instruction.a);
        if (instruction.b != no_operand) visit(instruction.b);
    }

    // The lag shared by the operands of an instruction; constants have no time and do not count.
    [[nodiscard]] std::int64_t operand_lag(const Instruction& instruction) const noexcept;

    // Whether the value of an instruction is a truth value, by those of its operands.
    [[nodiscard]] bool is_truth(const Instruction& instruction) const noexcept;

    // Whether an instruction can make NaN of operands that are none. A finite number that is added
    // or subtracted cannot, nor one that is not 0 as a factor or divisor: predicates such as x
    // >= 3.
    [[nodiscard]] bool can_fail(const Instruction& instruction) const noexcept;

    // By instruction, whether it is guarded: it can fail, or one that can is computed from it.
    [[nodiscard]] std::vector<bool> guarded() const;

    // Whether an operand is a constant; no_operand is not.
    [[nodiscard]] bool is_constant(std::uint32_t operand) const noexcept {
        return operand != no_operand && instructions[operand].opcode == Opcode::constant;
    }

    // How many slots after the last sample the last output becomes known.
    [[nodiscard]] std::int64_t latest() const noexcept;
};

} // namespace rtamt
