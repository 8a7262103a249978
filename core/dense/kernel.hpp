// The interface of kernels in dense time: one virtual call for a stretch of time, events in and
// out.
//
// Arrival time: with lag L, what happens at time t arrives at s = t + L. In arrival time, all that
// happens up to the frontier is known. A run moves the frontier: the operands bring their events
// since the last one, and the kernel gives its own up to the new frontier, that instant included.
// An instruction begins at its start, that of the trace plus its lag, and its first event is there.
// No value is undefined: a kernel that can compute such a value returns its time, and the executor
// rolls the update back. Only kernels depend on the type of values (values/domain.hpp).
#pragma once

#include "../program/snapshot.hpp"
#include "../values/domain.hpp"
#include "../values/vectors.hpp"
#include "events.hpp"

#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace rtamt::dense {

class Kernel {
  public:
    explicit Kernel(std::int64_t lag) noexcept : lag_(lag) {}
    virtual ~Kernel() = default;
    Kernel(const Kernel&) = delete;
    Kernel& operator=(const Kernel&) = delete;
    Kernel(Kernel&&) = delete;
    Kernel& operator=(Kernel&&) = delete;

    // A new trace begins at this time.
    void begin(std::int64_t time) noexcept {
        start_ = later(time, lag_);
        reset();
    }

    // Moves the frontier; returns the first arrival of a value that is undefined, or never.
    virtual std::int64_t run(std::int64_t frontier) = 0;

    // What went wrong where run() returns a time and no value is undefined: null but for calls.
    [[nodiscard]] virtual const char* fault() const noexcept { return nullptr; }

    // Remembers the state; takes back everything since then.
    virtual void checkpoint() noexcept = 0;
    virtual void rollback() noexcept = 0;

    // Writes or reads what the samples up to the frontier have left behind; not between
    // checkpoint() and rollback(). A kernel that reads has begun as the one that wrote.
    virtual void transfer(Snapshot& snapshot, std::int64_t frontier) = 0;

    // How many events can follow without any more from the operands.
    [[nodiscard]] virtual std::size_t pending() const noexcept { return 0; }

    [[nodiscard]] virtual std::size_t bytes() const noexcept = 0;

    // Where the events of the operands are, of the types that the kernel reads.
    void connect(const void* a, const void* b) noexcept {
        a_ = a;
        b_ = b;
    }

    // Where the events of the last run are, of the type that the kernel writes.
    [[nodiscard]] virtual const void* result() const noexcept = 0;

  protected:
    virtual void reset() noexcept = 0;

    template <class Value>
    [[nodiscard]] const BasicEvents<Value>& a() const noexcept {
        return *static_cast<const BasicEvents<Value>*>(a_);
    }
    template <class Value>
    [[nodiscard]] const BasicEvents<Value>& b() const noexcept {
        return *static_cast<const BasicEvents<Value>*>(b_);
    }
    [[nodiscard]] std::int64_t start() const noexcept { return start_; }

  private:
    const void* a_ = nullptr;
    const void* b_ = nullptr;
    std::int64_t lag_;
    std::int64_t start_ = 0;
};

// A kernel that writes values of one type.
template <class Value>
class Writing : public Kernel {
  public:
    using Kernel::Kernel;

    [[nodiscard]] std::size_t bytes() const noexcept override { return list_.bytes(); }
    [[nodiscard]] const void* result() const noexcept override { return &out_; }

    // The events of the last run.
    [[nodiscard]] const BasicEvents<Value>& out() const noexcept { return out_; }

  protected:
    // Where to write up to `count` events; then, how many there are.
    [[nodiscard]] BasicEventList<Value>& room(std::size_t count) {
        list_.make_room(count);
        return list_;
    }
    void publish(std::size_t count) noexcept {
        list_.resize(count);
        out_ = list_.view();
    }

  private:
    BasicEventList<Value> list_;
    BasicEvents<Value> out_;
};

// A kernel whose state is one value, from which all that keeps and takes back state follows.
template <class Value, class State>
class Scalar : public Writing<Value> {
  public:
    explicit Scalar(std::int64_t lag, const State& initial = {}) noexcept
        : Writing<Value>(lag), initial_(initial), state_(initial), saved_(initial) {}

    void checkpoint() noexcept override { saved_ = state_; }
    void rollback() noexcept override { state_ = saved_; }
    void transfer(Snapshot& snapshot, std::int64_t /*frontier*/) override {
        state_.transfer(snapshot);
    }

  protected:
    void reset() noexcept override { state_ = initial_; }
    [[nodiscard]] State& state() noexcept { return state_; }
    [[nodiscard]] const State& state() const noexcept { return state_; }

  private:
    State initial_;
    State state_;
    State saved_;
};

// What a kernel has put out so far, and what it keeps itself, which is one value.
template <class Value, class Own>
struct Progress {
    Value last;         // the value at the frontier
    bool begun = false; // whether the start has been put out
    [[no_unique_address]] Own own{};

    void transfer(Snapshot& snapshot) {
        snapshot.item(last);
        if constexpr (!std::is_empty_v<Own>) snapshot.item(own);
    }
};

struct Nothing {};

// A kernel whose result need not begin where its operands do. Values before its start are held
// back, and the last one is put out at the start. `Own` is the state of the kernel itself.
template <ValueDomain D, class Own = Nothing>
class Temporal : public Scalar<typename D::Value, Progress<typename D::Value, Own>> {
  public:
    using Value = typename D::Value;
    using Base = Scalar<Value, Progress<Value, Own>>;

    // `before` is the value as long as the operands have brought nothing.
    Temporal(std::int64_t lag, const Value& before) noexcept : Base(lag, {before}) {}

    void transfer(Snapshot& snapshot, std::int64_t frontier) override {
        Base::transfer(snapshot, frontier);
        this->state().begun = this->start() <= frontier;
    }

  protected:
    [[nodiscard]] Own& own() noexcept { return this->state().own; }
    [[nodiscard]] const Own& own() const noexcept { return this->state().own; }

    // Takes events, at most one an instant, and merges those that change nothing. A copy on the
    // stack, so that the loop around it need not reload it after every store.
    struct Writer {
        std::int64_t* times;
        Value* values;
        std::size_t count;
        std::int64_t start;
        Value last; // the value so far
        bool begun;

        RTAMT_INLINE void put(std::int64_t time, const Value& next) noexcept {
            const Value value = next; // which no store can change
            if (time <= start) [[unlikely]] {
                last = value;
                return;
            }
            if (!begun) [[unlikely]] {
                begin();
            }
            times[count] = time;
            values[count] = value;
            count += value == last ? 0 : 1;
            last = value;
        }

        void begin() noexcept {
            times[count] = start;
            values[count] = last;
            ++count;
            begun = true;
        }
    };

    // For at most `count` calls of put().
    [[nodiscard]] Writer open(std::size_t count) {
        BasicEventList<Value>& list =
            this->room(count + 2); // the start, and one that changes nothing
        return {list.times(),  list.values(),      0,
                this->start(), this->state().last, this->state().begun};
    }

    void close(Writer& writer, std::int64_t frontier) noexcept {
        if (!writer.begun && writer.start <= frontier) writer.begin();
        this->state().last = writer.last;
        this->state().begun = writer.begun;
        this->publish(writer.count);
    }
};

} // namespace rtamt::dense
