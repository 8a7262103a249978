#include "dense/feed.hpp"

#include "ways.hpp"

using dense_oracle::signal_of;
using Feed = rtamt::dense::Feed<double>;
using rtamt::dense::never;
using ways::Signal;

namespace {

// The signal must outlive the update.
void attach(Feed& feed, const Signal& signal) {
    feed.attach(signal.events(0, signal.size()));
}

Signal loaded(Feed& feed, std::int64_t time, std::size_t limit = 100) {
    feed.load(time, limit);
    return signal_of(feed.view());
}

} // namespace

TEST(what_is_left_over_waits_for_the_next_update) {
    Feed feed;
    {
        const Signal signal{{1, 3, 5}, {1, 2, 3}};
        attach(feed, signal);
        CHECK((loaded(feed, 3) == Signal{{1, 3}, {1, 2}}));
        feed.settle();
    }
    CHECK(feed.first() == 1 && feed.last() == 5);
    const Signal more{{7, 9}, {4, 5}};
    attach(feed, more);
    CHECK((loaded(feed, 4) == Signal{}));
    CHECK((loaded(feed, 7, 1) == Signal{{5}, {3}}));
    CHECK((loaded(feed, 7) == Signal{{7}, {4}}));
    feed.rewind();
    CHECK(feed.reach(3) == never && feed.reach(2) == 7 && feed.reach(1) == 5);
    CHECK((loaded(feed, 100) == Signal{{5, 7, 9}, {3, 4, 5}}));
    feed.settle();
    feed.attach({});
    CHECK((loaded(feed, 100) == Signal{}));
    CHECK(feed.last() == 9);
}

TEST(an_update_that_is_restored_never_was) {
    Feed feed;
    const Signal first{{1, 3}, {1, 2}};
    attach(feed, first);
    feed.restore();
    CHECK(!feed.first() && !feed.last());
    attach(feed, first);
    CHECK((loaded(feed, 1) == Signal{{1}, {1}}));
    feed.settle();
    const Signal second{{8}, {8}};
    attach(feed, second);
    CHECK((loaded(feed, 100) == Signal{{3, 8}, {2, 8}}));
    feed.restore();
    CHECK(feed.last() == 3);
    const Signal third{{4}, {4}};
    attach(feed, third);
    CHECK((loaded(feed, 100) == Signal{{3, 4}, {2, 4}}));
}

TEST(a_trace_begins_with_the_value_at_its_start) {
    Feed feed;
    const Signal signal{{1, 3, 5, 8}, {1, 2, 3, 4}};
    attach(feed, signal);
    feed.begin(6);
    CHECK((signal_of(feed.view()) == Signal{{6}, {3}}));
    CHECK((loaded(feed, 100) == Signal{{8}, {4}}));
    feed.rewind();
    feed.begin(8);
    CHECK((signal_of(feed.view()) == Signal{{8}, {4}}));
    CHECK((loaded(feed, 100) == Signal{}));
}

TEST(a_queue_that_empties_is_reused) {
    Feed feed;
    for (std::int64_t t = 0; t < 100000; ++t) { // always three samples behind
        const Signal sample{{t}, {0.5}};
        attach(feed, sample);
        feed.load(t - 3, 100);
        CHECK(feed.view().count == (t < 3 ? 0U : 1U));
        feed.settle();
    }
    CHECK(feed.bytes() <= 256);
    feed.reset();
    CHECK(!feed.first());
}
