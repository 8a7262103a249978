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

// The last value that a pointwise kernel has emitted.
template <class Value>
struct Emitted {
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

    Results(BasicEventList<Value>& list, const Emitted<Value>& emitted) noexcept
        : times_(list.times()), values_(list.values()), emitted_(emitted) {}

    void put(std::int64_t time, const Value& value) noexcept {
        times_[count_] = time;
        values_[count_] = value;
        count_ += static_cast<std::size_t>(!emitted_.begun | (value != emitted_.last));
        emitted_ = {value, true};
        if constexpr (Operation::partial) undefined_ |= D::undefined(value);
    }

    [[nodiscard]] std::size_t count() const noexcept { return count_; }
    [[nodiscard]] const Emitted<Value>& emitted() const noexcept { return emitted_; }

    [[nodiscard]] std::int64_t first_undefined() const noexcept {
        if (!undefined_) [[likely]] {
            return never;
        }
        for (std::size_t i = 0; i < count_; ++i) {
            if (D::undefined(values_[i])) return times_[i];
        }
        return never; // undefined before this run, and reported then
    }

  private:
    std::int64_t* __restrict times_;
    Value* __restrict values_;
    std::size_t count_ = 0;
    Emitted<Value> emitted_;
    bool undefined_ = false;
};

template <class Operation>
class Unary final
    : public Scalar<typename Operation::Out::Value, Emitted<typename Operation::Out::Value>> {
  public:
    using In = typename Operation::In::Value;
    using Out = typename Operation::Out::Value;

    explicit Unary(std::int64_t lag) noexcept : Scalar<Out, Emitted<Out>>(lag) {}

    std::int64_t run(std::int64_t /*frontier*/) override {
        const BasicEvents<In> a = Kernel::a<In>();
        Results<Operation> results(this->room(a.count + 1), this->state());
        for (std::size_t i = 0; i < a.count; ++i)
            results.put(a.times[i], Operation::of(a.values[i]));
        this->state() = results.emitted();
        this->publish(results.count());
        return results.first_undefined();
    }
};

// The operands at the frontier, and the last value emitted.
template <class In, class Out>
struct Combined {
    Pair<In> operands;
    Emitted<Out> emitted;

    void transfer(Snapshot& snapshot) {
        snapshot.item(operands);
        emitted.transfer(snapshot);
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
        Results<Operation> results(this->room(a.count + b.count + 1), state.emitted);
        merge(a, b, state.operands, [&](std::int64_t time, const Pair<In>& now) {
            results.put(time, Operation::of(now.a, now.b));
        });
        state.emitted = results.emitted();
        this->publish(results.count());
        return results.first_undefined();
    }
};

} // namespace rtamt::dense
