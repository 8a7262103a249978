// What every kernel is in dense time: one virtual call for a stretch of time, events in and out.
//
// Arrival time: with lag L, what happens at time t arrives at s = t + L. In arrival time, all that
// happens up to the frontier is known. A run moves the frontier: the operands bring their events
// since the last one, and the kernel gives its own up to the new frontier, that instant included.
// An instruction begins at its start, that of the trace plus its lag, and its first event is there.
// No value is undefined: a kernel that can make such a value says when, and the executor takes the
// update back. Of which type values are is known to the kernels alone (values/domain.hpp).
#pragma once

#include "../program/snapshot.hpp"
#include "../values/domain.hpp"
#include "events.hpp"

#include <cstddef>
#include <cstdint>

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

    // Moves the frontier; answers the first arrival of a value that is undefined, or never.
    virtual std::int64_t run(std::int64_t frontier) = 0;

    // What went wrong where run() answers a time and no value is undefined: null but for calls.
    [[nodiscard]] virtual const char* fault() const noexcept { return nullptr; }

    // Remembers the state; takes back everything since then.
    virtual void checkpoint() noexcept = 0;
    virtual void rollback() noexcept = 0;

    // Writes or reads what the samples up to the frontier have left behind; not between
    // checkpoint() and rollback(). A kernel that reads has begun as the one that wrote.
    virtual void transfer(Snapshot& snapshot, std::int64_t frontier) = 0;

    // How many events can come without any more from the operands.
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

// A kernel whose result need not begin where its operands do. What it says before its start is
// held back, and its value at the start told there.
template <ValueDomain D>
class Temporal : public Writing<typename D::Value> {
  public:
    using Value = typename D::Value;

    // `before` is the value as long as the operands have brought nothing.
    Temporal(std::int64_t lag, const Value& before) noexcept
        : Writing<Value>(lag), before_(before), told_{before, false}, saved_(told_) {}

    void checkpoint() noexcept override { saved_ = told_; }
    void rollback() noexcept override { told_ = saved_; }
    void transfer(Snapshot& snapshot, std::int64_t frontier) override {
        snapshot.item(told_.last);
        told_.begun = this->start() <= frontier;
    }

  protected:
    // Takes events, at most one an instant, and merges those that change nothing. A copy on the
    // stack, so that the loop around it need not reload it after every store.
    struct Writer {
        std::int64_t* times;
        Value* values;
        std::size_t count;
        std::int64_t start;
        Value last; // the value so far
        bool begun;

        void put(std::int64_t time, const Value& next) noexcept {
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
        return {list.times(), list.values(), 0, this->start(), told_.last, told_.begun};
    }

    void close(Writer& writer, std::int64_t frontier) noexcept {
        if (!writer.begun && writer.start <= frontier) writer.begin();
        told_ = {writer.last, writer.begun};
        this->publish(writer.count);
    }

    void reset() noexcept override { told_ = {before_, false}; }

  private:
    struct Told {
        Value last;
        bool begun;
    };

    Value before_;
    Told told_;
    Told saved_;
};

} // namespace rtamt::dense
