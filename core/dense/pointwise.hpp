// Functions of the operands at the same instant: arithmetic, comparison, and, or, not.
//
// Cost: one pass over the operands' events. Memory: the operands' values at the frontier.
#pragma once

#include "../discrete/pointwise.hpp"
#include "kernel.hpp"
#include "merge.hpp"

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace rtamt::dense {

namespace pointwise = discrete::pointwise; // the functions themselves know no time

// Writes the results, merges those that change nothing, and finds the first that is NaN. The
// result of a pointwise function begins where its operands do, so nothing is ever held back.
//
// Equal is equal to the bit here: 1/x tells 0.0 from -0.0.
template <bool partial>
class Results {
  public:
    // No operation makes these bits, a signalling NaN, so the first result is always an event.
    static constexpr std::uint64_t none = 0x7FF0'0000'0000'0001U;

    Results(EventList& list, std::uint64_t last) noexcept
        : times_(list.times()), values_(list.values()), last_(last) {}

    void put(std::int64_t time, double value) noexcept {
        const auto bits = std::bit_cast<std::uint64_t>(value);
        times_[count_] = time;
        values_[count_] = value;
        count_ += bits != last_ ? 1 : 0;
        last_ = bits;
        if constexpr (partial) undefined_ |= std::isnan(value);
    }

    [[nodiscard]] std::size_t count() const noexcept { return count_; }
    [[nodiscard]] std::uint64_t last() const noexcept { return last_; }

    [[nodiscard]] std::int64_t first_undefined() const noexcept {
        if (!undefined_) [[likely]] {
            return never;
        }
        for (std::size_t i = 0; i < count_; ++i) {
            if (std::isnan(values_[i])) return times_[i];
        }
        return never; // NaN already before this run, and told then
    }

  private:
    std::int64_t* __restrict times_;
    double* __restrict values_;
    std::size_t count_ = 0;
    std::uint64_t last_;
    bool undefined_ = false;
};

template <class Function>
class Unary final : public Kernel {
  public:
    using Kernel::Kernel;

    std::int64_t run(std::int64_t /*frontier*/) override {
        const Events a = this->a();
        Results<Function::partial> results(room(a.count + 1), last_);
        for (std::size_t i = 0; i < a.count; ++i)
            results.put(a.times[i], Function::of(a.values[i]));
        last_ = results.last();
        publish(results.count());
        return results.first_undefined();
    }

    void checkpoint() noexcept override { saved_ = last_; }
    void rollback() noexcept override { last_ = saved_; }
    void transfer(Snapshot& snapshot, std::int64_t /*frontier*/) override { snapshot.item(last_); }

  protected:
    void reset() noexcept override { last_ = Results<Function::partial>::none; }

  private:
    std::uint64_t last_ = 0;
    std::uint64_t saved_ = 0;
};

template <class Function>
class Binary final : public Kernel {
  public:
    using Kernel::Kernel;

    std::int64_t run(std::int64_t /*frontier*/) override {
        const Events a = this->a();
        const Events b = this->b();
        Results<Function::partial> results(room(a.count + b.count + 1), state_.last);
        merge(a, b, state_.operands, [&](std::int64_t time, const Pair& now) {
            results.put(time, Function::of(now.a, now.b));
        });
        state_.last = results.last();
        publish(results.count());
        return results.first_undefined();
    }

    void checkpoint() noexcept override { saved_ = state_; }
    void rollback() noexcept override { state_ = saved_; }
    void transfer(Snapshot& snapshot, std::int64_t /*frontier*/) override { snapshot.item(state_); }

  protected:
    void reset() noexcept override { state_ = {{}, Results<Function::partial>::none}; }

  private:
    struct State {
        Pair operands;
        std::uint64_t last = 0;
    };
    State state_;
    State saved_;
};

} // namespace rtamt::dense
