#include "dense/kernel.hpp"

#include "ways.hpp"

using dense_oracle::signal_of;
using rtamt::dense::Events;
using rtamt::dense::never;
using Temporal = rtamt::dense::Temporal<rtamt::Real>;
using ways::Signal;

namespace {

// Tells what it reads.
class Echo final : public Temporal {
  public:
    explicit Echo(std::int64_t lag) : Temporal(lag, -1.0) {}

    std::int64_t run(std::int64_t frontier) override {
        const Events a = this->a<double>();
        Writer out = open(a.count);
        for (std::size_t i = 0; i < a.count; ++i)
            out.put(a.times[i], a.values[i]);
        close(out, frontier);
        return never;
    }
};

Signal emitted(Echo& echo, const Signal& signal, std::int64_t frontier) {
    const Events events = signal.events(0, signal.size());
    echo.connect(&events, nullptr);
    CHECK(echo.run(frontier) == never);
    return signal_of(echo.out());
}

} // namespace

TEST_CASE("what comes before the start is one event at the start") {
    Echo echo(5);
    echo.begin(10);
    CHECK((emitted(echo, {{10, 11}, {1, 2}}, 12) == Signal{}));
    CHECK((emitted(echo, {{14}, {3}}, 14) == Signal{}));
    CHECK((emitted(echo, {{18}, {4}}, 20) == Signal{{15, 18}, {3, 4}}));
    echo.begin(10);
    CHECK((emitted(echo, {{15}, {7}}, 15) == Signal{{15}, {7}}));
    echo.begin(10);
    CHECK((emitted(echo, {}, 20) == Signal{{15}, {-1}}));
}

TEST_CASE("a value that does not change is not emitted") {
    Echo echo(0);
    echo.begin(0);
    CHECK((emitted(echo, {{0, 1, 2}, {-1, -1, 3}}, 2) == Signal{{0, 2}, {-1, 3}}));
    CHECK((emitted(echo, {{3, 4}, {3, 5}}, 4) == Signal{{4}, {5}}));
}

TEST_CASE("an update that is taken back emits nothing") {
    Echo echo(0);
    echo.begin(0);
    echo.checkpoint();
    CHECK((emitted(echo, {{0}, {1}}, 0) == Signal{{0}, {1}}));
    echo.rollback();
    CHECK((emitted(echo, {{0}, {2}}, 0) == Signal{{0}, {2}}));
    echo.checkpoint();
    CHECK((emitted(echo, {{1}, {3}}, 1) == Signal{{1}, {3}}));
    echo.rollback();
    CHECK((emitted(echo, {{1, 2}, {2, 3}}, 2) == Signal{{2}, {3}}));
}

TEST_CASE("a start beyond the last tick never comes") {
    Echo echo(100);
    echo.begin(never - 50);
    CHECK((emitted(echo, {{never - 40}, {2}}, never - 1) == Signal{}));
}
