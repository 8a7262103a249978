// The operand d slots ago, or a given value where it was absent then: prev, next, once[d,d], and
// the delays that line up operands of different lags.
//
// Cost: two copies a sample. Memory: d values, touched as far as the trace has come.
#pragma once

#include "copy.hpp"
#include "journal.hpp"
#include "kernel.hpp"

namespace rtamt::discrete {

template <class Value>
class Shift final : public Kernel {
  public:
    Shift(std::int64_t operand_lag, std::size_t distance, Value absent, Value* ring,
          Value* journal) noexcept
        : Kernel(operand_lag), ring_(ring), distance_(distance), absent_(absent),
          journal_(journal) {}

    std::size_t run(const Block& block) noexcept override {
        const Range present = block.present(lag());
        // Before its first sample the operand leaves nothing behind: the ring starts with it.
        auto* out = this->out<Value>();
        fill_values(out, present.begin, absent_);
        push({a<Value>() + present.begin, absent_}, out + present.begin,
             present.end - present.begin);
        push({nullptr, absent_}, out + present.end, block.count - present.end);
        return defined;
    }

    void reset() noexcept override { state_ = {}; }

    void checkpoint(std::size_t count) noexcept override {
        saved_ = state_;
        if (count <= distance_ - state_.next) {
            journal_.save(ring_, state_.next, state_.full ? count : 0);
        } else {
            journal_.save(ring_, 0, state_.full ? distance_ : state_.next);
        }
    }

    void rollback() noexcept override {
        state_ = saved_;
        journal_.restore(ring_);
    }

    void transfer(Snapshot& snapshot) override {
        snapshot.item(state_.next);
        snapshot.item(state_.full);
        snapshot.require(state_.next <= distance_);
        snapshot.values(ring_, state_.full ? distance_ : state_.next);
    }

  private:
    // Consecutive values of the operand, or as many of the value that stands for absent ones.
    struct Source {
        const Value* values;
        Value absent;

        void copy(std::size_t offset, std::size_t count, Value* target) const noexcept {
            if (values != nullptr) {
                copy_values(values + offset, count, target);
            } else {
                fill_values(target, count, absent);
            }
        }
    };

    struct State {
        std::size_t next = 0; // cell to be written next; when the ring is full, the oldest one
        bool full = false;
    };

    Value* ring_;
    std::size_t distance_;
    Value absent_;
    State state_;
    State saved_;
    Journal<Value> journal_;

    void push(Source source, Value* out, std::size_t count) noexcept {
        if (count == 0) return;
        if (count >= distance_) {
            drain(out);
            source.copy(0, count - distance_, out + distance_);
            source.copy(count - distance_, distance_, ring_);
            state_ = {0, distance_ != 0};
            return;
        }
        for (std::size_t done = 0; done < count;) {
            Value* cells = ring_ + state_.next;
            const std::size_t part = std::min(count - done, distance_ - state_.next);
            if (state_.full) {
                copy_values(cells, part, out + done);
            } else {
                fill_values(out + done, part, absent_);
            }
            source.copy(done, part, cells);
            done += part;
            state_.next += part;
            if (state_.next == distance_) state_ = {0, true};
        }
    }

    // The whole ring, oldest first.
    void drain(Value* out) const noexcept {
        const std::size_t rest = distance_ - state_.next;
        if (state_.full) {
            copy_values(ring_ + state_.next, rest, out);
        } else {
            fill_values(out, rest, absent_);
        }
        copy_values(ring_, state_.next, out + rest);
    }
};

} // namespace rtamt::discrete
