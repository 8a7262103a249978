// What every kernel is in dense time: one virtual call for a stretch of time, events in and out.
//
// Arrival time: with lag L, what happens at time t arrives at s = t + L. In arrival time, all that
// happens up to the frontier is known. A run moves the frontier: the operands bring their events
// since the last one, and the kernel gives its own up to the new frontier, that instant included.
// An instruction begins at its start, that of the trace plus its lag, and its first event is there.
// No value is NaN: a kernel that can make one says when, and the executor takes the update back.
#pragma once

#include "../snapshot.hpp"
#include "events.hpp"

#include <bit>
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

    // Moves the frontier; answers the first arrival of a value that is NaN, or never.
    virtual std::int64_t run(std::int64_t frontier) = 0;

    // What went wrong where run() answers a time and no value is NaN: null but for calls.
    [[nodiscard]] virtual const char* fault() const noexcept { return nullptr; }

    // Remembers the state; takes back everything since then.
    virtual void checkpoint() noexcept = 0;
    virtual void rollback() noexcept = 0;

    // Writes or reads what the samples up to the frontier have left behind; not between
    // checkpoint() and rollback(). A kernel that reads has begun as the one that wrote.
    virtual void transfer(Snapshot& snapshot, std::int64_t frontier) = 0;

    // How many events can come without any more from the operands.
    [[nodiscard]] virtual std::size_t pending() const noexcept { return 0; }

    [[nodiscard]] virtual std::size_t bytes() const noexcept { return list_.bytes(); }

    void connect(const Events* a, const Events* b) noexcept {
        a_ = a;
        b_ = b;
    }

    // The events of the last run.
    [[nodiscard]] const Events& out() const noexcept { return out_; }

  protected:
    virtual void reset() noexcept = 0;

    [[nodiscard]] const Events& a() const noexcept { return *a_; }
    [[nodiscard]] const Events& b() const noexcept { return *b_; }
    [[nodiscard]] std::int64_t start() const noexcept { return start_; }

    // Where to write up to `count` events; then, how many there are.
    [[nodiscard]] EventList& room(std::size_t count) {
        list_.make_room(count);
        return list_;
    }
    void publish(std::size_t count) noexcept {
        list_.resize(count);
        out_ = list_.view();
    }

  private:
    const Events* a_ = nullptr;
    const Events* b_ = nullptr;
    EventList list_;
    Events out_;
    std::int64_t lag_;
    std::int64_t start_ = 0;
};

// A kernel whose result need not begin where its operands do. What it says before its start is
// held back, and its value at the start told there.
class Temporal : public Kernel {
  public:
    // `before` is the value as long as the operands have brought nothing.
    Temporal(std::int64_t lag, double before) noexcept
        : Kernel(lag), before_(before), told_{before, false}, saved_(told_) {}

    void checkpoint() noexcept override { saved_ = told_; }
    void rollback() noexcept override { told_ = saved_; }
    void transfer(Snapshot& snapshot, std::int64_t frontier) override {
        snapshot.item(told_.last);
        told_.begun = start() <= frontier;
    }

  protected:
    // Takes events, at most one an instant, and merges those that change nothing. A copy on the
    // stack, so that the loop around it need not reload it after every store.
    struct Writer {
        std::int64_t* times;
        double* values;
        std::size_t count;
        std::int64_t start;
        double last; // the value so far
        bool begun;

        void put(std::int64_t time, double value) noexcept {
            if (time <= start) [[unlikely]] {
                last = value;
                return;
            }
            if (!begun) [[unlikely]] {
                begin();
            }
            times[count] = time;
            values[count] = value;
            const bool change =
                std::bit_cast<std::uint64_t>(value) != std::bit_cast<std::uint64_t>(last);
            count += change ? 1 : 0;
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
        EventList& list = room(count + 2); // the start, and one that changes nothing
        return {list.times(), list.values(), 0, start(), told_.last, told_.begun};
    }

    void close(Writer& writer, std::int64_t frontier) noexcept {
        if (!writer.begun && writer.start <= frontier) writer.begin();
        told_ = {writer.last, writer.begun};
        publish(writer.count);
    }

    void reset() noexcept override { told_ = {before_, false}; }

  private:
    struct Told {
        double last;
        bool begun;
    };

    double before_;
    Told told_;
    Told saved_;
};

} // namespace rtamt::dense
