// The c-th smallest (or largest) value of the last w slots, +inf (or -inf) where fewer are present:
// atleast, wasatleast.
//
// Each component of a value has its own selection. An update is rolled back slot by slot: the
// journal holds what was in those that it has overwritten.
//
// Cost: O(log w) a sample and component. Memory: 24 bytes a slot and component, touched as far as
// the trace has come.
#pragma once

#include "../values/components.hpp"
#include "kernel.hpp"
#include "selection.hpp"

#include <array>
#include <utility>

namespace rtamt::discrete {

template <ValueDomain D, bool least>
class Rank final : public Kernel {
  public:
    using Value = typename D::Value;
    using Parts = Components<D>;
    static constexpr std::size_t slot_size = Parts::count * Selection::slot_size;

    Rank(std::int64_t operand_lag, std::size_t width, double order, void* memory,
         void* journal) noexcept
        : Kernel(operand_lag), width_(width),
          selections_(selections(width, static_cast<std::size_t>(order),
                                 static_cast<std::byte*>(memory),
                                 std::make_index_sequence<Parts::count>{})),
          journal_(static_cast<Old*>(journal)) {}

    std::size_t run(const Block& block) noexcept override {
        const Range present = block.present(lag());
        const auto* in = a<Value>();
        auto* out = this->out<Value>();
        std::fill_n(out, present.begin, outside);
        for (std::size_t i = present.begin; i < present.end; ++i) {
            const Value value = in[i];
            push(&value);
            out[i] = result();
        }
        for (std::size_t i = present.end; i < block.count; ++i) {
            push(nullptr);
            out[i] = result();
        }
        return defined;
    }

    void reset() noexcept override {
        state_ = {};
        for (Selection& selection : selections_)
            selection.clear();
    }

    void checkpoint(std::size_t /*count*/) noexcept override {
        saved_ = state_;
        kept_ = 0;
        keeping_ = true;
    }

    void rollback() noexcept override {
        for (std::size_t i = 0; i < kept_; ++i) {
            const std::size_t slot = (saved_.next + i) % width_;
            for (std::size_t part = 0; part < Parts::count; ++part) {
                Selection& selection = selections_[part];
                const Old& old = journal_[part * width_ + i];
                const bool now = selection.contains(slot);
                if (!old.present) {
                    if (now) selection.remove(slot);
                } else if (now) {
                    selection.replace(slot, old.key);
                } else {
                    selection.insert(slot, old.key);
                }
            }
        }
        state_ = saved_;
        keeping_ = false;
    }

    void transfer(Snapshot& snapshot) override {
        snapshot.item(state_.next);
        snapshot.item(state_.used);
        snapshot.require(state_.next < width_ && state_.used <= width_);
        snapshot.require(state_.used == width_ || state_.used == state_.next);
        for (Selection& selection : selections_) {
            if (snapshot.loading()) selection.clear();
            for (std::size_t slot = 0; slot < state_.used; ++slot) {
                bool present = !snapshot.loading() && selection.contains(slot);
                double value = present ? Keys::value(selection.key(slot)) : 0.0;
                snapshot.item(present);
                snapshot.item(value);
                if (!snapshot.loading()) continue;
                snapshot.require(!std::isnan(value));
                present ? selection.insert(slot, Keys::of(value)) : selection.leave_out(slot);
            }
        }
    }

  private:
    using Keys = Key<least>;
    static constexpr Value outside = least ? D::top : D::bottom;

    struct State {
        std::size_t next = 0; // slot to be written next; when all are used, the oldest one
        std::size_t used = 0;
    };
    // What was in a slot.
    struct Old {
        Selection::Key key;
        bool present;
    };
    static_assert(sizeof(Old) <= Selection::slot_size);

    std::size_t width_;
    std::array<Selection, Parts::count> selections_;
    Old* journal_;
    State state_;
    State saved_;
    std::size_t kept_ = 0; // slots in the journal
    bool keeping_ = false;

    template <std::size_t... part>
    [[nodiscard]] static std::array<Selection, Parts::count>
    selections(std::size_t width, std::size_t order, std::byte* memory,
               std::index_sequence<part...>) noexcept {
        return {Selection(width, order, memory + part * width * Selection::slot_size)...};
    }

    // The next value, or none.
    void push(const Value* value) noexcept {
        const std::size_t slot = state_.next;
        const bool fresh = state_.used < width_;
        const bool keep = keeping_ && kept_ < width_;
        for (std::size_t part = 0; part < Parts::count; ++part) {
            Selection& selection = selections_[part];
            const bool present = !fresh && selection.contains(slot);
            if (keep) {
                journal_[part * width_ + kept_] = {present ? selection.key(slot) : 0, present};
            }
            if (value != nullptr) {
                const auto key = Keys::of(Parts::get(*value, part));
                present ? selection.replace(slot, key) : selection.insert(slot, key);
            } else if (present) {
                selection.remove(slot);
            } else {
                selection.leave_out(slot);
            }
        }
        kept_ += static_cast<std::size_t>(keep);
        state_.used += static_cast<std::size_t>(fresh);
        state_.next = slot + 1 == width_ ? 0 : slot + 1;
    }

    [[nodiscard]] Value result() const noexcept {
        Value value = outside;
        for (std::size_t part = 0; part < Parts::count; ++part) {
            const Selection& selection = selections_[part];
            if (selection.found()) Parts::set(value, part, Keys::value(selection.selected()));
        }
        return value;
    }
};

} // namespace rtamt::discrete
