// A chain of pointwise instructions (program/fusion.hpp) as one kernel: the steps of a strip.
//
// Members are computed in the order of the program. What the next member takes stays in the
// accumulator, everything else is stored for a strip. The commonest groups of members are one step:
// the terms of step.hpp. A value that may be NaN is checked unless NaN reaches a member that is;
// only when one was seen is every member looked at, in a step of its own.
//
// Lanes are computed as so many doubles more at a slot.
//
// Cost: that of strip.hpp. Memory: a strip for each constant and each value that is stored.
#pragma once

#include "../program/fusion.hpp"
#include "../program/program.hpp"
#include "../values/lanes.hpp"
#include "kernel.hpp"
#include "step.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace rtamt::discrete {

// The steps of a chain, and the operands that they number. If members may fail, the same without
// terms, with the member that each step computes.
struct ChainCode {
    std::vector<Step> steps;
    std::vector<Step> single_steps;
    std::vector<std::uint32_t> computes; // by single step: a member that may fail, or no_operand
    std::vector<std::uint32_t> columns;  // operands that are registers: their instructions
    std::vector<double> constants;       // operands after these
    std::size_t stored = 0;              // operands after these
};

// Makes the code of the chain with these members, in the order of the program.
[[nodiscard]] ChainCode chain_code(const Program& program, const Fusion& fusion,
                                   std::span<const std::uint32_t> members);

// How many doubles a value of a domain is for a chain; 0 if there are no chains.
template <class D>
inline constexpr std::size_t chain_width = 0;
template <>
inline constexpr std::size_t chain_width<Real> = 1;
template <std::size_t n>
inline constexpr std::size_t chain_width<Lanes<n>> = n;

class Chain final : public Kernel {
  public:
    // `width`: doubles at each slot.
    Chain(ChainCode code, std::int64_t lag, std::size_t width = 1);

    // The instructions whose registers are read, and where the addresses of these belong.
    [[nodiscard]] std::span<const std::uint32_t> columns() const noexcept { return code_.columns; }
    [[nodiscard]] const void** column(std::size_t i) noexcept { return &operands_[i]; }

    // For blocks of a number of slots.
    void make_room(std::size_t slots);

    std::size_t run(const Block& block) noexcept override;
    [[nodiscard]] std::uint32_t culprit(std::uint32_t root) const noexcept override;
    void transfer(Snapshot& /*snapshot*/) override {}

  private:
    ChainCode code_;
    std::vector<const void*> operands_; // their values
    std::vector<std::size_t> moves_;    // and whether these are columns
    std::vector<double> memory_;        // constants, and what steps store
    std::size_t width_;
    std::size_t stride_ = 0; // of strips in memory
    std::uint32_t culprit_ = 0;

    [[nodiscard]] Memory memory(std::span<const Step> steps) noexcept;
    [[nodiscard]] std::size_t first_undefined(Range range) noexcept;
    [[nodiscard]] std::size_t first_undefined_step(std::size_t place) noexcept;
};

} // namespace rtamt::discrete
