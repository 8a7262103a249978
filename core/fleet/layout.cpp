#include "layout.hpp"

#include "../program/sorts.hpp"
#include "kernels.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace rtamt::fleet {

namespace {

// A record is addressed with 32 bits.
constexpr std::size_t largest_record = std::numeric_limits<std::uint32_t>::max();

// FNV-1a with 64 bits, of numbers in little endian order.
class Hash {
  public:
    void byte(std::uint8_t byte) noexcept { value_ = (value_ ^ byte) * 0x100000001B3U; }
    void number(std::uint64_t number) noexcept {
        for (unsigned i = 0; i < 8; ++i)
            byte(static_cast<std::uint8_t>(number >> (8U * i)));
    }
    void text(std::string_view text) noexcept {
        number(text.size());
        for (const char c : text)
            byte(static_cast<std::uint8_t>(c));
    }
    [[nodiscard]] std::uint64_t value() const noexcept { return value_; }

  private:
    std::uint64_t value_ = 0xCBF29CE484222325U;
};

// Whether the operands may change places.
[[nodiscard]] bool commutes(Opcode opcode) noexcept {
    return opcode == Opcode::add || opcode == Opcode::mul || opcode == Opcode::min ||
           opcode == Opcode::max;
}

[[nodiscard]] std::uint64_t hash_of(const Program& program, const Instruction& instruction,
                                    std::span<const std::string> names,
                                    std::span<const std::uint64_t> hashes) {
    std::vector<std::uint64_t> operands;
    program.each_operand(instruction,
                         [&](std::uint32_t operand) { operands.push_back(hashes[operand]); });
    if (commutes(instruction.opcode)) std::ranges::sort(operands);
    Hash hash;
    hash.number(state_version);
    hash.text(info(instruction.opcode).name);
    hash.number(operands.size());
    for (const std::uint64_t operand : operands)
        hash.number(operand);
    if (instruction.opcode == Opcode::input) {
        hash.text(names[static_cast<std::size_t>(instruction.n)]);
    } else {
        hash.number(std::bit_cast<std::uint64_t>(instruction.n));
    }
    hash.number(std::bit_cast<std::uint64_t>(instruction.x));
    hash.number(std::bit_cast<std::uint64_t>(instruction.lag));
    return hash.value();
}

// Records that need more than half of a cache line begin with one.
[[nodiscard]] std::size_t rounded(std::size_t size) noexcept {
    if (size <= 32) return std::bit_ceil(size);
    return (size + 63) / 64 * 64;
}

} // namespace

Layout::Layout(const Program& program, std::span<const std::string> names, bool warming)
    : warming_(warming) {
    if constexpr (std::endian::native != std::endian::little) { // for state.cpp
        throw std::invalid_argument("A fleet needs a machine with little endian numbers.");
    }
    if (program.domain != Domain::discrete) {
        throw std::invalid_argument("A fleet runs programs for discrete time.");
    }
    if (names.size() != program.inputs) {
        throw std::invalid_argument("Got " + std::to_string(names.size()) +
                                    " names for a program with " + std::to_string(program.inputs) +
                                    " inputs.");
    }
    if (!program.calls.empty()) {
        throw std::invalid_argument("A fleet runs no kernels that are not of the core.");
    }
    const std::vector<Sort> sorts = rtamt::sorts(program);
    if (program.latest() > 0) {
        times_ = static_cast<std::size_t>(program.latest()) + 1;
    }
    std::size_t offset = sizeof(Header) + (clocked() ? sizeof(ClockState) : 0);
    std::vector<std::size_t> heads;
    std::size_t tails = times_ * sizeof(double);
    const auto require = [](bool holds) {
        if (holds) return;
        throw std::invalid_argument("The state of a key would have 4 GiB or more: make the time "
                                    "bounds smaller or the period longer.");
    };
    require(times_ < largest_record / 8);
    for (std::uint32_t i = 0; i < program.instructions.size(); ++i) {
        const Instruction& instruction = program.instructions[i];
        hashes_.push_back(hash_of(program, instruction, names, hashes_));
        const bool sized = info(instruction.opcode).count == Count::width ||
                           info(instruction.opcode).count == Count::distance ||
                           info(instruction.opcode).count == Count::rank;
        require(!sized || std::cmp_less(instruction.n, largest_record / 64));
        kernels_.push_back(make_kernel_of(program, instruction, sorts[i]));
        heads.push_back(offset);
        const auto& kernel = kernels_.back();
        if (!kernel || kernel->sizes().head == 0) continue;
        parts_.push_back({i, hashes_[i]});
        offset += kernel->sizes().head;
        tails += kernel->sizes().tail;
        require(offset + tails < largest_record);
    }
    exact_offset_ = offset;
    if (warming_) offset += (1 + parts_.size() + program.outputs.size()) * sizeof(std::int64_t);
    hot_size_ = offset;
    ring_offset_ = offset;
    offset += times_ * sizeof(double);
    for (const Part& part : parts_) {
        Kernel& kernel = *kernels_[part.instruction];
        kernel.place(heads[part.instruction], offset);
        offset += kernel.sizes().tail;
    }
    require(offset < largest_record - 64);
    record_size_ = rounded(offset);
}

void Layout::start(std::byte* record) const noexcept {
    for (const Part& part : parts_)
        kernels_[part.instruction]->start(record, 0);
}

} // namespace rtamt::fleet
