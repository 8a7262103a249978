#include "dense/call.hpp"

#include "check.hpp"
#include "dense/executor.hpp"
#include "programs.hpp"

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

using programs::Builder;
using rtamt::dense::EventList;
using rtamt::dense::Events;
using rtamt::dense::Executor;

namespace {

// The operand `end` ticks later.
class Ahead {
  public:
    explicit Ahead(const rtamt_setup& setup) : distance_(setup.end) {}

    void run(const rtamt_stretch& stretch) {
        const rtamt_events& events = stretch.operands[0];
        for (std::size_t i = 0; i < events.count; ++i) {
            const std::int64_t time = events.times[i] - distance_;
            if (time <= stretch.start) {
                first_ = events.values[i];
            } else {
                begin(stretch);
                stretch.emit(stretch.sink, time, events.values[i]);
            }
        }
        if (stretch.due >= stretch.start) begin(stretch);
    }

  private:
    std::int64_t distance_;
    double first_ = 0;
    bool begun_ = false;

    void begin(const rtamt_stretch& stretch) {
        if (!begun_) stretch.emit(stretch.sink, stretch.start, first_);
        begun_ = true;
    }
};

const rtamt_kernel ahead = rtamt::KernelOf<Ahead>::table();

rtamt::Program program(const rtamt_kernel& kernel) {
    Builder builder;
    const auto late = builder.unary(rtamt::Opcode::shift, builder.input(), 2, 2);
    builder.output(builder.call(kernel, {0, 5, 1e-9, 1}, {late}, 7));
    builder.dense();
    return builder.program();
}

struct Heard {
    std::vector<std::int64_t> times;
    std::vector<double> values;
    std::string fault;

    void take(const std::optional<rtamt::dense::Failure>& failure, const EventList& list) {
        if (failure) fault = failure->fault.text();
        const Events events = list.view();
        times.insert(times.end(), events.times, events.times + events.count);
        values.insert(values.end(), events.values, events.values + events.count);
    }
};

// x is 1 from tick 10, 4 from 13, 2 from 20 and 3 from 21 on, in updates of one sample or in one.
Heard run(const rtamt_kernel& kernel, bool whole) {
    const std::vector<std::int64_t> times{10, 13, 20, 21};
    const std::vector<double> values{1, 4, 2, 3};
    Executor executor(program(kernel));
    Heard heard;
    const std::size_t step = whole ? times.size() : 1;
    for (std::size_t i = 0; i < times.size(); i += step) {
        std::vector<EventList> out(1);
        const std::vector<Events> in{{times.data() + i, values.data() + i, step}};
        heard.take(executor.push(in, out), out[0]);
    }
    std::vector<EventList> out(1);
    heard.take(executor.finish(out), out[0]);
    return heard;
}

// Says the same thing whatever comes.
template <std::int64_t time>
class Stubborn {
  public:
    explicit Stubborn(const rtamt_setup& /*setup*/) {}
    void run(const rtamt_stretch& stretch) {
        if (time >= 0) stretch.emit(stretch.sink, stretch.start + time, 1);
    }
};

// Tells the future.
class Hasty {
  public:
    explicit Hasty(const rtamt_setup& /*setup*/) {}
    void run(const rtamt_stretch& stretch) {
        stretch.emit(stretch.sink, stretch.start, 1);
        stretch.emit(stretch.sink, std::max(stretch.start, stretch.due) + 1, 1);
    }
};

} // namespace

TEST_CASE("a call counts time as the trace does") {
    for (const bool whole : {true, false}) {
        const Heard heard = run(ahead, whole);
        CHECK((heard.times == std::vector<std::int64_t>{10, 15, 16}));
        CHECK((heard.values == std::vector<double>{4, 2, 3}));
        CHECK(heard.fault.empty());
    }
}

TEST_CASE("what no kernel may say is a fault") {
    CHECK(run(rtamt::KernelOf<Stubborn<-1>>::table(), true).fault ==
          "it gave no value at the start of the trace");
    CHECK(run(rtamt::KernelOf<Stubborn<1>>::table(), true).fault ==
          "its first value is not at the start of the trace");
    CHECK(run(rtamt::KernelOf<Stubborn<0>>::table(), false).fault ==
          "its values are not in the order of time");
    CHECK(run(rtamt::KernelOf<Hasty>::table(), true).fault ==
          "it gave a value that is not due yet");
}
