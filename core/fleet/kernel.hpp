// The kernels of a fleet: one instruction over a block of samples, each of another key.
//
// The state of a key is one record of fixed size. A kernel has two parts of it: a head of a few
// bytes, next to those of all other instructions, and a tail, the ring of a window or a delay.
// Kernels compute what those of core/discrete do, step by step and in the same order, so that every
// bit is the same.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace rtamt::fleet {

// How many keys an instruction is computed for at once: their samples fit into the first cache, and
// the cells that they need are requested from memory before the first is used.
inline constexpr std::size_t block_size = 64;

// One sample of each of up to 64 keys.
struct Block {
    std::size_t count = 0;
    std::byte* const* records = nullptr;
    const std::int64_t* slots = nullptr; // the number of earlier samples of the key
    std::int64_t least = 0;              // of these

    // Whether the operands of this lag are present for every key.
    [[nodiscard]] bool present(std::int64_t lag) const noexcept { return least >= lag; }
};

inline constexpr std::int64_t endless = 4'611'686'018'427'387'904;

inline void prefetch(const void* memory) noexcept {
#if defined(__GNUC__)
    __builtin_prefetch(memory);
#else
    (void)memory;
#endif
}

// Bytes in a record, multiples of 8.
struct Sizes {
    std::size_t head = 0;
    std::size_t tail = 0;
};

class Kernel {
  public:
    explicit Kernel(std::int64_t operand_lag, Sizes sizes = {}) noexcept
        : sizes_(sizes), lag_(operand_lag) {}
    virtual ~Kernel() = default;
    Kernel(const Kernel&) = delete;
    Kernel& operator=(const Kernel&) = delete;
    Kernel(Kernel&&) = delete;
    Kernel& operator=(Kernel&&) = delete;

    // Operands where they are not present may be anything.
    virtual void run(const Block& block, const double* a, const double* b,
                     double* out) const noexcept = 0;

    // The state after `pushes` operands of which nothing is remembered.
    virtual void start(std::byte* /*record*/, std::int64_t /*pushes*/) const noexcept {}

    // Whether the monitor can continue with a restored state; may complete derived values.
    [[nodiscard]] virtual bool accept(std::byte* /*record*/) const noexcept { return true; }

    // How many operands before the last one a value is computed from; endless: all.
    [[nodiscard]] virtual std::int64_t look_back() const noexcept { return 0; }

    void place(std::size_t head, std::size_t tail) noexcept {
        head_ = head;
        tail_ = tail;
    }
    [[nodiscard]] Sizes sizes() const noexcept { return sizes_; }
    [[nodiscard]] std::size_t head_offset() const noexcept { return head_; }
    [[nodiscard]] std::size_t tail_offset() const noexcept { return tail_; }
    [[nodiscard]] std::int64_t lag() const noexcept { return lag_; }

  protected:
    template <class Head>
    [[nodiscard]] Head& head(std::byte* record) const noexcept {
        return *reinterpret_cast<Head*>(record + head_);
    }
    template <class Cell>
    [[nodiscard]] Cell* tail(std::byte* record) const noexcept {
        return reinterpret_cast<Cell*>(record + tail_);
    }

    // Calls take(lane) for each key whose operands are present, and skip(lane) for the others.
    template <class Take, class Skip>
    void each(const Block& block, Take&& take, Skip&& skip) const noexcept {
        if (block.present(lag_)) [[likely]] {
            for (std::size_t i = 0; i < block.count; ++i)
                take(i);
            return;
        }
        for (std::size_t i = 0; i < block.count; ++i)
            block.slots[i] >= lag_ ? take(i) : skip(i);
    }

  private:
    Sizes sizes_;
    std::size_t head_ = 0;
    std::size_t tail_ = 0;
    std::int64_t lag_;
};

} // namespace rtamt::fleet
