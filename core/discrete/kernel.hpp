// The interface of kernels: one virtual call for a block of slots, operands and result in
// registers.
//
// A value is present at slot s of an instruction with lag L where 0 <= s - L < samples. Registers
// hold anything at all in absent slots, and kernels skip these in their operands: that one rule
// cuts every window at both ends of the trace. Where values are present, they are never undefined:
// a kernel that can compute such a value returns its place, and the executor then rolls the update
// back.
//
// Only the kernel knows the type of its registers: numbers or formulas of a value domain
// (values/domain.hpp).
#pragma once

#include "../program/snapshot.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace rtamt::discrete {

// Half-open range of places in a block.
struct Range {
    std::size_t begin;
    std::size_t end;
};

// The length of a trace that has not ended yet.
inline constexpr std::int64_t endless = std::numeric_limits<std::int64_t>::max() / 2;

struct Block {
    std::int64_t slot;    // the first slot
    std::size_t count;    // how many slots
    std::int64_t samples; // length of the trace, or endless

    [[nodiscard]] Range present(std::int64_t lag) const noexcept {
        const auto size = static_cast<std::int64_t>(count);
        const std::int64_t begin = std::clamp<std::int64_t>(lag - slot, 0, size);
        const std::int64_t end = std::clamp<std::int64_t>(lag + samples - slot, begin, size);
        return {static_cast<std::size_t>(begin), static_cast<std::size_t>(end)};
    }

    // The part of a range in which values of a lag are not past the end of the trace.
    [[nodiscard]] Range until_end(Range range, std::int64_t lag) const noexcept {
        return {range.begin, std::clamp(present(lag).end, range.begin, range.end)};
    }
};

class Kernel {
  public:
    // The result of run() when no value is undefined.
    static constexpr std::size_t defined = std::numeric_limits<std::size_t>::max();

    explicit Kernel(std::int64_t operand_lag) noexcept : lag_(operand_lag) {}
    virtual ~Kernel() = default;
    Kernel(const Kernel&) = delete;
    Kernel& operator=(const Kernel&) = delete;
    Kernel(Kernel&&) = delete;
    Kernel& operator=(Kernel&&) = delete;

    // Computes a block; returns the first place where a present value is undefined, or `defined`.
    virtual std::size_t run(const Block& block) noexcept = 0;

    // Back to the state before the first slot, in a time that does not depend on the state's size.
    virtual void reset() noexcept {}

    // Remembers the state, of which at most the next `count` slots will be taken back.
    virtual void checkpoint(std::size_t /*count*/) noexcept {}

    // Takes back everything since the checkpoint.
    virtual void rollback() noexcept {}

    // What went wrong where run() returns a place and no value is undefined: null but for calls.
    [[nodiscard]] virtual const char* fault() const noexcept { return nullptr; }

    // Which instruction's value is undefined where run() returns a place, given the one whose
    // register is written.
    [[nodiscard]] virtual std::uint32_t culprit(std::uint32_t instruction) const noexcept {
        return instruction;
    }

    // Writes or reads what the samples so far have left behind; not between checkpoint() and
    // rollback().
    virtual void transfer(Snapshot& snapshot) = 0;

    // Where the registers are; again whenever they have moved.
    void connect(const void* a, const void* b, void* out) noexcept {
        a_ = a;
        b_ = b;
        out_ = out;
    }

    // Where the address of one of them is kept.
    [[nodiscard]] const void** a_cell() noexcept { return &a_; }
    [[nodiscard]] const void** b_cell() noexcept { return &b_; }
    [[nodiscard]] void** out_cell() noexcept { return &out_; }

  protected:
    template <class Value>
    [[nodiscard]] const Value* a() const noexcept {
        return static_cast<const Value*>(a_);
    }
    template <class Value>
    [[nodiscard]] const Value* b() const noexcept {
        return static_cast<const Value*>(b_);
    }
    template <class Value>
    [[nodiscard]] Value* out() const noexcept {
        return static_cast<Value*>(out_);
    }
    [[nodiscard]] std::int64_t lag() const noexcept { return lag_; }

  private:
    const void* a_ = nullptr;
    const void* b_ = nullptr;
    void* out_ = nullptr;
    std::int64_t lag_;
};

// A kernel whose state is one value, from which all that keeps and takes back state follows.
template <class State>
class Scalar : public Kernel {
  public:
    Scalar(std::int64_t operand_lag, const State& initial) noexcept
        : Kernel(operand_lag), initial_(initial), state_(initial), saved_(initial) {}

    void reset() noexcept override { state_ = initial_; }
    void checkpoint(std::size_t /*count*/) noexcept override { saved_ = state_; }
    void rollback() noexcept override { state_ = saved_; }
    void transfer(Snapshot& snapshot) override { snapshot.item(state_); }

  protected:
    [[nodiscard]] State& state() noexcept { return state_; }

  private:
    State initial_;
    State state_;
    State saved_;
};

} // namespace rtamt::discrete
