#include "dense/events.hpp"

#include "ways.hpp"

using dense_oracle::signal_of;
using rtamt::dense::EventList;
using rtamt::dense::Events;
using rtamt::dense::later;
using rtamt::dense::never;
using ways::Signal;

TEST_CASE("what is later than the last tick is never") {
    CHECK((later(3, 4) == 7 && later(-5, 0) == -5));
    CHECK(later(never - 2, 1) == never - 1);
    CHECK((later(never - 2, 2) == never && later(never - 2, 3) == never));
    CHECK((later(never, 0) == never && later(never, never) == never && later(-never, never) == 0));
}

TEST_CASE("until counts the events at a time or before within the limit") {
    const Signal signal{{1, 4, 6, 9}, {0, 0, 0, 0}};
    const Events events = signal.events(0, 4);
    CHECK((events.until(0, 4) == 0 && events.until(1, 4) == 1 && events.until(5, 4) == 2));
    CHECK((events.until(6, 4) == 3 && events.until(9, 4) == 4 && events.until(100, 4) == 4));
    CHECK((events.until(100, 2) == 2 && events.until(3, 2) == 1 && events.until(3, 0) == 0));
    CHECK(Events{}.until(3, 5) == 0);
    CHECK((signal_of(events.from(3)) == Signal{{9}, {0}}));
}

TEST_CASE("a list grows and loses its front") {
    EventList list;
    Signal expected;
    for (int i = 0; i < 1000; ++i) {
        list.append(i, 2.0 * i);
        expected.add(i, 2.0 * i);
    }
    CHECK(signal_of(list.view()) == expected);
    list.append(expected.events(0, 1000));
    CHECK((list.count() == 2000 && list.view().times[1500] == 500));
    list.erase_front(1990);
    CHECK((list.count() == 10 && list.view().values[0] == 1980.0));
    const std::size_t bytes = list.bytes();
    list.make_room(1500);
    CHECK((list.count() == 0 && list.bytes() == bytes));
}
