// The bounds of a formula at the start of the trace, which may have operators of unbounded future
// above all bounded ones: of these, what is final is folded into one number.
//
//     kind    value
//     value   of a at a tick
//     all     the least of a from the tick on
//     some    the greatest of a from the tick on
//     until   of a, the recursion of until over operands b and c, at the tick
//     both    the smaller of items a and b
//     either  the larger of items a and b
//
// A value is put together in the same way from what the windows at the top of its formula read, so
// that nothing follows the values of these windows at other ticks, nor keeps what is final. Of
// samples in order, until over operands of one instant folds each sample as it comes, and nothing
// follows the recursion.
#pragma once

#include "bounds_engine.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace rtamt::early {

struct Item {
    enum class Kind : std::uint8_t { value, all, some, until, both, either };
    Kind kind{};
    bool negated = false;
    std::uint32_t a = none; // references; of both and either, items
    std::uint32_t b = none;
    std::uint32_t c = none;
    Tick tick = 0;
    Tick last = forever;    // of all and some: the last tick
    Tick settled = forever; // the tick whose samples make the value final, if any do
};

class BoundsAtStart {
  public:
    // What items are: as they are given, which continue after they are decided; or put together,
    // for samples that may be late, or for samples in order.
    enum class Use : std::uint8_t { as_given, late, in_order };

    // The last item is that of the formula. `outputs`: what is followed at all ticks anyway.
    BoundsAtStart(std::vector<Item> items, const BoundsEngine& engine,
                  std::span<const std::uint32_t> outputs = {}, Use use = Use::late);

    // Throws for items that are none of a graph of so many nodes.
    static void check(std::span<const Item> items, std::size_t nodes);

    // The last tick of each node that is looked at, where it is later.
    void limit(std::span<Tick> last) const noexcept;

    // What is read at every tick.
    [[nodiscard]] std::vector<std::uint32_t> read_forever() const;

    // Reads the current bounds of the engine. `closed`: up to where inputs are final, if they are
    // samples in order.
    void read(const BoundsEngine& engine, Tick closed = -1);

    [[nodiscard]] Bounds value() const noexcept { return bounds_of(formula_); }

    // Folds what is final; `wanted`: by node, the first tick that is still needed.
    void settle(const BoundsEngine& engine, Tick closed, std::span<Tick> wanted);

    // The bounds when the trace ends just before `end`.
    [[nodiscard]] Bounds ended(const BoundsEngine& engine, Tick end) const;

    // Of an item: a register of its value, before it is negated; of until, how far hold goes over
    // the ticks before next().
    [[nodiscard]] std::size_t size() const noexcept { return items_.size(); }
    [[nodiscard]] const Item& item(std::size_t item) const noexcept { return items_[item]; }
    [[nodiscard]] double value(std::size_t item, int reg) const noexcept {
        return states_[item].value[static_cast<std::size_t>(reg)];
    }
    [[nodiscard]] double held(std::size_t item, int reg) const noexcept {
        return states_[item].held[static_cast<std::size_t>(reg)];
    }
    [[nodiscard]] Tick next(std::size_t item) const noexcept { return states_[item].next; }

    void transfer(Snapshot& snapshot);

  private:
    // Of each register: the value; of what is folded the best, and for until how far hold goes.
    struct State {
        std::array<double, 2> value{-infinity, -infinity};
        std::array<double, 2> best{};
        std::array<double, 2> held{};
        Tick next = 0; // the first tick that is not folded
    };
    std::vector<Item> items_;
    std::vector<State> states_;
    std::size_t formula_; // the item of it
    Use use_;
    std::vector<bool> folds_; // by item: until that folds each sample

    void put_together(const Graph& graph, std::span<const std::uint32_t> outputs);
    [[nodiscard]] double seen(const BoundsEngine& engine, std::size_t item, int reg) const noexcept;
    [[nodiscard]] Bounds bounds_of(std::size_t item) const noexcept;
    [[nodiscard]] bool decided(std::size_t item) const noexcept;
    void fold(const BoundsEngine& engine, std::size_t item, Tick end) noexcept;
    void find_folds(const Graph& graph);
};

} // namespace rtamt::early
