// What every kernel is: one virtual call for a block of slots, operands and result in registers.
//
// A value is present at slot s of an instruction with lag L where 0 <= s - L < samples. Registers
// hold anything at all in absent slots, and kernels skip these in their operands: that one rule
// cuts every window at both ends of the trace. Where values are present, they are never NaN: a
// kernel that can make one says where it did, and the executor then takes the update back.
#pragma once

#include "snapshot.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace rtamt {

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
};

class Kernel {
  public:
    // The answer of run() when no value is NaN.
    static constexpr std::size_t defined = std::numeric_limits<std::size_t>::max();

    explicit Kernel(std::int64_t operand_lag) noexcept : lag_(operand_lag) {}
    virtual ~Kernel() = default;
    Kernel(const Kernel&) = delete;
    Kernel& operator=(const Kernel&) = delete;
    Kernel(Kernel&&) = delete;
    Kernel& operator=(Kernel&&) = delete;

    // Computes a block; answers the first place where a present value is NaN, or `defined`.
    virtual std::size_t run(const Block& block) noexcept = 0;

    // Back to the state before the first slot, in a time that does not depend on the state's size.
    virtual void reset() noexcept {}

    // Remembers the state, of which at most the next `count` slots will be taken back.
    virtual void checkpoint(std::size_t /*count*/) noexcept {}

    // Takes back everything since the checkpoint.
    virtual void rollback() noexcept {}

    // What went wrong where run() answers a place and no value is NaN: null but for calls.
    [[nodiscard]] virtual const char* fault() const noexcept { return nullptr; }

    // Writes or reads what the samples so far have left behind; not between checkpoint() and
    // rollback().
    virtual void transfer(Snapshot& snapshot) = 0;

    // Where the registers are; again whenever they have moved.
    void connect(const double* a, const double* b, double* out) noexcept {
        a_ = a;
        b_ = b;
        out_ = out;
    }

    // One of these alone; the others stay.
    void read_a(const double* a) noexcept { a_ = a; }
    void read_b(const double* b) noexcept { b_ = b; }
    void write(double* out) noexcept { out_ = out; }

  protected:
    [[nodiscard]] const double* a() const noexcept { return a_; }
    [[nodiscard]] const double* b() const noexcept { return b_; }
    [[nodiscard]] double* out() const noexcept { return out_; }
    [[nodiscard]] std::int64_t lag() const noexcept { return lag_; }

  private:
    const double* a_ = nullptr;
    const double* b_ = nullptr;
    double* out_ = nullptr;
    std::int64_t lag_;
};

} // namespace rtamt
