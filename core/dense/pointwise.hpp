// Functions of the operands at the same instant: arithmetic, comparison, and, or, not.
//
// Cost: one pass over the operands' events. Memory: the operands' values at the frontier, and the
// last result.
#pragma once

#include "../values/operations.hpp"
#include "kernel.hpp"
#include "merge.hpp"

#include <cstddef>
#include <cstdint>

namespace rtamt::dense {

// What a pointwise kernel has told so far.
template <class Value>
struct Told {
    Value last{};
    bool begun = false; // whether there is a last one

    void transfer(Snapshot& snapshot) {
        snapshot.item(last);
        snapshot.item(begun);
    }
};

// Writes the results, merges those that change nothing, and finds the first that is undefined. The
// result of a pointwise function begins where its operands do, so nothing is ever held back.
template <class Operation>
class Results {
  public:
    using D = typename Operation::Out;
    using Value = typename D::Value;

    Results(BasicEventList<Value>& list, const Told<Value>& told) noexcept
        : times_(list.times()), values_(list.values()), told_(told) {}

    void put(std::int64_t time, const Value& value) noexcept {
        times_[count_] = time;
        values_[count_] = value;
        count_ += static_cast<std::size_t>(!told_.begun | (value != told_.last));
        told_ = {value, true};
        if constexpr (Operation::partial) undefined_ |= D::undefined(value);
    }

    [[nodiscard]] std::size_t count() const noexcept { return count_; }
    [[nodiscard]] const Told<Value>& told() const noexcept { return told_; }

    [[nodiscard]] std::int64_t first_undefined() const noexcept {
        if (!undefined_) [[likely]] {
            return never;
        }
        for (std::size_t i = 0; i < count_; ++i) {
            if (D::undefined(values_[i])) return times_[i];
        }
        return never; // undefined already before this run, and told then
    }

  private:
    std::int64_t* __restrict times_;
    Value* __restrict values_;
    std::size_t count_ = 0;
    Told<Value> told_;
    bool undefined_ = false;
};

template <class Operation>
class Unary final
    : public Scalar<typename Operation::Out::Value, Told<typename Operation::Out::Value>> {
  public:
    using In = typename Operation::In::Value;
    using Out = typename Operation::Out::Value;

    explicit Unary(std::int64_t lag) noexcept : Scalar<Out, Told<Out>>(lag) {}

    std::int64_t run(std::int64_t /*frontier*/) override {
        const BasicEvents<In> a = Kernel::a<In>();
        Results<Operation> results(this->room(a.count + 1), this->state());
        for (std::size_t i = 0; i < a.count; ++i)
            results.put(a.times[i], Operation::of(a.values[i]));
        this->state() = results.told();
        this->publish(results.count());
        return results.first_undefined();
    }
};

// The operands at the frontier, and what was told.
template <class In, class Out>
struct Combined {
    Pair<In> operands;
    Told<Out> told;

    void transfer(Snapshot& snapshot) {
        snapshot.item(operands);
        told.transfer(snapshot);
    }
};

template <class Operation>
class Binary final
    : public Scalar<typename Operation::Out::Value,
                    Combined<typename Operation::In::Value, typename Operation::Out::Value>> {
  public:
    using In = typename Operation::In::Value;
    using Out = typename Operation::Out::Value;

    explicit Binary(std::int64_t lag) noexcept : Scalar<Out, Combined<In, Out>>(lag) {}

    std::int64_t run(std::int64_t /*frontier*/) override {
        const BasicEvents<In> a = Kernel::a<In>();
        const BasicEvents<In> b = Kernel::b<In>();
        Combined<In, Out>& state = this->state();
        Results<Operation> results(this->room(a.count + b.count + 1), state.told);
        merge(a, b, state.operands, [&](std::int64_t time, const Pair<In>& now) {
            results.put(time, Operation::of(now.a, now.b));
        });
        state.told = results.told();
        this->publish(results.count());
        return results.first_undefined();
    }
};

} // namespace rtamt::dense
