// Which kernels read a trace, and write results, where the caller has them: no copy to a register
// and back.
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
#include <memory>
#include <span>
#include <vector>

namespace rtamt::discrete {

class ZeroCopy {
  public:
    ZeroCopy() = default;

    ZeroCopy(const Program& program, std::span<const std::unique_ptr<Kernel>> kernels)
        : reads_input_(program.instructions.size(), true), written_(program.outputs.size(), false) {
        std::vector<std::size_t> uses(program.instructions.size(), 0);
        for (const std::uint32_t output : program.outputs) {
            ++uses[output];
            reads_input_[output] = false;
        }
        for (std::size_t i = 0; i < kernels.size(); ++i) {
            const Instruction& instruction = program.instructions[i];
            program.each_operand(instruction, [&](std::uint32_t operand) {
                ++uses[operand];
                if (instruction.opcode == Opcode::call) reads_input_[operand] = false;
            });
        }
        for (std::size_t i = 0; i < kernels.size(); ++i) {
            const Instruction& instruction = program.instructions[i];
            if (!kernels[i] || instruction.opcode == Opcode::call) continue;
            read(program, *kernels[i], instruction.a, &Kernel::read_a);
            read(program, *kernels[i], instruction.b, &Kernel::read_b);
        }
        for (std::size_t output = 0; output < program.outputs.size(); ++output) {
            const std::uint32_t i = program.outputs[output];
            if (!kernels[i] || program.instructions[i].opcode == Opcode::call || uses[i] > 1) {
                continue;
            }
            writers_.push_back({kernels[i].get(), output, program.instructions[i].lag});
        }
    }

    // Whether an input's register is not looked at.
    [[nodiscard]] bool skips(std::uint32_t input) const noexcept {
        return !readers_.empty() && reads_input_[input];
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
                (reader.kernel->*reader.read)(columns[reader.column] + offset);
        }
        for (const Writer& writer : writers_) {
            const Range present = block.present(writer.lag);
            const bool whole = present.begin == 0 && present.end == block.count;
            written_[writer.output] = whole;
            writer.kernel->write(whole ? place(writer.output, writer.lag) : home(writer.output));
        }
    }

  private:
    using Read = void (Kernel::*)(const void*) noexcept;
    struct Reader {
        Kernel* kernel;
        Read read;
        std::size_t column;
    };
    struct Writer {
        Kernel* kernel;
        std::size_t output;
        std::int64_t lag;
    };
    std::vector<Reader> readers_;
    std::vector<Writer> writers_;
    std::vector<bool> reads_input_; // by instruction: kernels of ours alone read it
    std::vector<bool> written_;     // by output

    void read(const Program& program, Kernel& kernel, std::uint32_t operand, Read side) {
        if (operand == no_operand || !reads_input_[operand]) return;
        const Instruction& input = program.instructions[operand];
        if (input.opcode != Opcode::input) return;
        readers_.push_back({&kernel, side, static_cast<std::size_t>(input.n)});
    }
};

} // namespace rtamt::discrete
