// Kernels that read a trace and write results in the caller's memory, without copies to and from
// registers.
//
// An input that only kernels read needs no register, nor does an output that nothing else reads:
// for each block these kernels use the caller's memory directly. Blocks with absent slots are
// excluded, since kernels may write any value there.
//
// Cost: a store a block for each operand or result; what it saves is a pass over the memory of each
// column. Memory: three words for each.
#pragma once

#include "../program/program.hpp"
#include "kernel.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace rtamt::discrete {

// Where a kernel keeps the address of an operand, which is the value of an instruction.
struct Read {
    const void** cell;
    std::uint32_t operand;
    bool once; // of a constant, which has one value and no register
};

// Where a kernel keeps the address of its result, the value of an instruction.
struct Write {
    void** cell;
    std::uint32_t instruction;
};

class ZeroCopy {
  public:
    // Given what kernels read and write, but for calls.
    ZeroCopy(const Program& program, std::span<const Read> reads, std::span<const Write> writes)
        : reads_input_(program.instructions.size(), true), written_(program.outputs.size(), false) {
        std::vector<std::size_t> uses(program.instructions.size(), 0);
        for (const std::uint32_t output : program.outputs) {
            ++uses[output];
            reads_input_[output] = false;
        }
        bool registers = !program.calls.empty();
        for (const Instruction& instruction : program.instructions) {
            registers = registers || instruction.lag != 0;
            program.each_operand(instruction, [&](std::uint32_t operand) {
                ++uses[operand];
                if (instruction.opcode == Opcode::call) reads_input_[operand] = false;
            });
        }
        for (const auto& [cell, operand, once] : reads) {
            const Instruction& input = program.instructions[operand];
            if (input.opcode == Opcode::input && reads_input_[operand]) {
                readers_.push_back({cell, static_cast<std::size_t>(input.n)});
            } else {
                registers = registers || !once;
            }
        }
        std::vector<void**> cells(program.instructions.size(), nullptr);
        for (const auto& [cell, instruction] : writes)
            cells[instruction] = cell;
        for (std::size_t output = 0; output < program.outputs.size(); ++output) {
            const std::uint32_t i = program.outputs[output];
            if (cells[i] == nullptr || uses[i] > 1) continue;
            writers_.push_back({cells[i], output, program.instructions[i].lag});
        }
        complete_ = !registers && !readers_.empty() && writers_.size() == writes.size() &&
                    writers_.size() == program.outputs.size();
    }

    // Whether no register is looked at: blocks may be longer than these.
    [[nodiscard]] bool complete() const noexcept { return complete_; }

    // Whether, besides, only one kernel reads the columns: longer blocks read nothing again.
    [[nodiscard]] bool single() const noexcept { return complete_ && writers_.size() == 1; }

    // Whether an input's register is not looked at.
    [[nodiscard]] bool skips(std::uint32_t input) const noexcept {
        return !readers_.empty() && reads_input_[input];
    }

    // The outputs whose registers are not looked at in blocks without absent slots.
    [[nodiscard]] std::vector<std::size_t> bypassed() const {
        std::vector<std::size_t> outputs;
        outputs.reserve(writers_.size());
        for (const Writer& writer : writers_)
            outputs.push_back(writer.output);
        return outputs;
    }

    // Whether the last bind_buffers() had this output written where it belongs.
    [[nodiscard]] bool written(std::size_t output) const noexcept {
        return !written_.empty() && written_[output];
    }

    // Before a block runs: of each column the block's first sample is at `offset`, and
    // `place(output, lag)` is where a result of the block's first slot belongs.
    template <class Value, class Place, class Register>
    void bind_buffers(std::span<const Value* const> columns, std::size_t offset, const Block& block,
                      Place&& place, Register&& home) noexcept {
        if (!columns.empty()) {
            for (const Reader& reader : readers_)
                *reader.cell = columns[reader.column] + offset;
        }
        for (const Writer& writer : writers_) {
            const Range present = block.present(writer.lag);
            const bool whole = present.begin == 0 && present.end == block.count;
            written_[writer.output] = whole;
            *writer.cell = whole ? place(writer.output, writer.lag) : home(writer.output);
        }
    }

  private:
    struct Reader {
        const void** cell;
        std::size_t column;
    };
    struct Writer {
        void** cell;
        std::size_t output;
        std::int64_t lag;
    };
    std::vector<Reader> readers_;
    std::vector<Writer> writers_;
    std::vector<bool> reads_input_; // by instruction: kernels of ours alone read it
    std::vector<bool> written_;     // by output
    bool complete_ = false;
};

} // namespace rtamt::discrete
