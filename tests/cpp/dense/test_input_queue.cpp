#include "dense/input_queue.hpp"

#include "ways.hpp"

using dense_oracle::signal_of;
using InputQueue = rtamt::dense::InputQueue<double>;
using rtamt::dense::never;
using ways::Signal;

namespace {

// The signal must outlive the update.
void attach(InputQueue& queue, const Signal& signal) {
    queue.attach(signal.events(0, signal.size()));
}

Signal loaded(InputQueue& queue, std::int64_t time, std::size_t limit = 100) {
    queue.load(time, limit);
    return signal_of(queue.view());
}

} // namespace

TEST_CASE("what is left over waits for the next update") {
    InputQueue queue;
    {
        const Signal signal{{1, 3, 5}, {1, 2, 3}};
        attach(queue, signal);
        CHECK((loaded(queue, 3) == Signal{{1, 3}, {1, 2}}));
        queue.settle();
    }
    CHECK((queue.first() == 1 && queue.last() == 5));
    const Signal more{{7, 9}, {4, 5}};
    attach(queue, more);
    CHECK((loaded(queue, 4) == Signal{}));
    CHECK((loaded(queue, 7, 1) == Signal{{5}, {3}}));
    CHECK((loaded(queue, 7) == Signal{{7}, {4}}));
    queue.rewind();
    CHECK((queue.reach(3) == never && queue.reach(2) == 7 && queue.reach(1) == 5));
    CHECK((loaded(queue, 100) == Signal{{5, 7, 9}, {3, 4, 5}}));
    queue.settle();
    queue.attach({});
    CHECK((loaded(queue, 100) == Signal{}));
    CHECK(queue.last() == 9);
}

TEST_CASE("an update that is restored never was") {
    InputQueue queue;
    const Signal first{{1, 3}, {1, 2}};
    attach(queue, first);
    queue.restore();
    CHECK((!queue.first() && !queue.last()));
    attach(queue, first);
    CHECK((loaded(queue, 1) == Signal{{1}, {1}}));
    queue.settle();
    const Signal second{{8}, {8}};
    attach(queue, second);
    CHECK((loaded(queue, 100) == Signal{{3, 8}, {2, 8}}));
    queue.restore();
    CHECK(queue.last() == 3);
    const Signal third{{4}, {4}};
    attach(queue, third);
    CHECK((loaded(queue, 100) == Signal{{3, 4}, {2, 4}}));
}

TEST_CASE("a trace begins with the value at its start") {
    InputQueue queue;
    const Signal signal{{1, 3, 5, 8}, {1, 2, 3, 4}};
    attach(queue, signal);
    queue.begin(6);
    CHECK((signal_of(queue.view()) == Signal{{6}, {3}}));
    CHECK((loaded(queue, 100) == Signal{{8}, {4}}));
    queue.rewind();
    queue.begin(8);
    CHECK((signal_of(queue.view()) == Signal{{8}, {4}}));
    CHECK((loaded(queue, 100) == Signal{}));
}

TEST_CASE("a queue that empties is reused") {
    InputQueue queue;
    for (std::int64_t t = 0; t < 100000; ++t) { // always three samples behind
        const Signal sample{{t}, {0.5}};
        attach(queue, sample);
        queue.load(t - 3, 100);
        CHECK(queue.view().count == (t < 3 ? 0U : 1U));
        queue.settle();
    }
    CHECK(queue.bytes() <= 256);
    queue.reset();
    CHECK(!queue.first());
}
