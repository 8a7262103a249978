// A kernel that is not of the core: stretches of time go to it through its table of functions.
//
// The kernel uses the time of the trace; here it is arrival time, later by the lag. Its results are
// checked, since it may be any user's code.
//
// Cost: a call a step of the frontier, a copy of the operands' times where they are late, and what
// the kernel itself takes. Memory: the events of a step, and the kernel's own.
#pragma once

#include "../program/foreign.hpp"
#include "kernel.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace rtamt::dense {

class Call final : public Writing<double> {
  public:
    Call(const rtamt_kernel& kernel, const rtamt_setup& setup, std::int64_t operand_lag,
         std::int64_t lag)
        : Writing(lag), foreign_(kernel, setup), operand_lag_(operand_lag), lag_(lag) {}

    void connect_operands(std::vector<const Events*> operands) {
        operands_ = std::move(operands);
        shifted_.resize(operands_.size());
        views_.resize(operands_.size());
    }

    std::int64_t run(std::int64_t frontier) override {
        publish(0);
        const std::int64_t origin = start() - lag_;
        if (frontier < origin + operand_lag_) return never; // nothing to take yet
        for (std::size_t i = 0; i < operands_.size(); ++i)
            views_[i] = view(*operands_[i], shifted_[i]);
        Sink sink{room(0), state_, origin, frontier - lag_, lag_};
        fault_ = foreign_.advance(
            {views_.data(), origin, frontier - operand_lag_, sink.due, &Sink::emit, &sink});
        if (fault_ == nullptr) fault_ = sink.fault;
        if (fault_ == nullptr && sink.due >= origin && !sink.emitted.begun) {
            fault_ = "it gave no value at the start of the trace";
        }
        if (fault_ != nullptr) return start();
        state_ = sink.emitted;
        publish(sink.list.count());
        return sink.undefined;
    }

    [[nodiscard]] const char* fault() const noexcept override { return fault_; }
    void checkpoint() noexcept override {
        foreign_.checkpoint();
        saved_ = state_;
    }
    void rollback() noexcept override {
        foreign_.rollback();
        state_ = saved_;
    }
    void transfer(Snapshot& /*snapshot*/, std::int64_t /*frontier*/) override {
        Foreign::refuse_transfer();
    }

  protected:
    void reset() noexcept override {
        foreign_.reset();
        state_ = {};
    }

  private:
    // The last value that was emitted.
    struct Emitted {
        std::int64_t time = 0;
        double value = 0.0;
        bool begun = false;
    };

    struct Sink {
        EventList& list;
        Emitted emitted;
        std::int64_t origin = 0;
        std::int64_t due = 0;
        std::int64_t lag = 0;
        std::int64_t undefined = never;
        const char* fault = nullptr;

        static void emit(void* sink, std::int64_t time, double value) {
            static_cast<Sink*>(sink)->put(time, value);
        }

        void put(std::int64_t time, double value) {
            if (!emitted.begun && time != origin) {
                fault = "its first value is not at the start of the trace";
            } else if (emitted.begun && time <= emitted.time) {
                fault = "its values are not in the order of time";
            } else if (time > due) {
                fault = "it gave a value that is not due yet";
            }
            if (fault != nullptr) return;
            const bool change = !emitted.begun || std::bit_cast<std::uint64_t>(value) !=
                                                      std::bit_cast<std::uint64_t>(emitted.value);
            emitted = {time, value, true};
            if (!change) return;
            list.append(time + lag, value);
            if (std::isnan(value)) undefined = std::min(undefined, time + lag);
        }
    };

    Foreign foreign_;
    std::int64_t operand_lag_;
    std::int64_t lag_;
    std::vector<const Events*> operands_;
    std::vector<std::vector<std::int64_t>> shifted_;
    std::vector<rtamt_events> views_;
    Emitted state_;
    Emitted saved_;
    const char* fault_ = nullptr;

    // The events as the kernel counts time.
    [[nodiscard]] rtamt_events view(const Events& events, std::vector<std::int64_t>& times) const {
        if (operand_lag_ == 0) return {events.times, events.values, events.count};
        times.assign(events.times, events.times + events.count);
        for (std::int64_t& time : times)
            time -= operand_lag_;
        return {times.data(), events.values, events.count};
    }
};

} // namespace rtamt::dense
