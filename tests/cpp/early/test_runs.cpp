#include "early/runs.hpp"

#include "check.hpp"
#include "oracle.hpp"
#include "program/snapshot.hpp"

using namespace early_oracle;
using namespace rtamt::early;

namespace {

struct Model {
    Tick ticks; // behind them all is as at the start
    std::vector<double> values = std::vector<double>(static_cast<std::size_t>(ticks) + 1, 0.0);

    [[nodiscard]] double at(Tick t) const {
        return values[static_cast<std::size_t>(std::min(t, ticks))];
    }
    [[nodiscard]] Run run(Tick t) const {
        Run run{std::min(t, ticks), std::min(t, ticks), at(t)};
        while (run.begin > 0 && at(run.begin - 1) == run.value)
            --run.begin;
        while (run.end < ticks && at(run.end + 1) == run.value)
            ++run.end;
        if (run.end == ticks) run.end = forever;
        return run;
    }
};

void check_equal(const std::optional<Run>& found, const std::optional<Run>& expected) {
    REQUIRE(found.has_value() == expected.has_value());
    if (!found) return;
    CHECK(found->begin == expected->begin);
    CHECK(found->end == expected->end);
    CHECK(found->value == expected->value);
}

template <class Search>
void check_search(const Runs& runs, const Model& model, Tick l, Tick r, double value) {
    std::optional<Run> first;
    std::optional<Run> last;
    for (Tick t = l; t <= r; ++t) {
        if (!Search::holds(model.at(t), value)) continue;
        Run run = model.run(t);
        run = {std::max(run.begin, l), std::min(run.end, r), run.value};
        if (!first) first = run;
        last = run;
        t = run.end;
    }
    check_equal(runs.first<Search>(l, r, value), first);
    check_equal(runs.last<Search>(l, r, value), last);
}

// What raise() does of an array, or of runs where it does nothing.
void check_raise(Runs& runs, Model& model, Tick front, Tick l, Tick r, double value) {
    Tick next = l;
    bool in_part = false;
    for (const Tick t : {l, r}) {
        const Run run = runs.at(t);
        in_part = in_part || (run.value < value && (run.begin < l || run.end > r));
    }
    const bool done = runs.raise(runs.find(l), l, r, value, [&](const Run& run) {
        const Run expected = model.run(run.begin);
        REQUIRE(std::max(run.begin, front) == std::max(expected.begin, front));
        REQUIRE(run.end == expected.end);
        REQUIRE(run.value == expected.value);
        REQUIRE(run.value < value);
        for (; next < run.begin; ++next)
            REQUIRE(model.at(next) >= value);
        next = run.end + 1;
    });
    REQUIRE(done == !in_part);
    if (!done) return;
    for (; next <= r; ++next)
        REQUIRE(model.at(next) >= value);
    for (Tick t = l; t <= r; ++t) {
        double& each = model.values[static_cast<std::size_t>(t)];
        each = std::max(each, value);
    }
    for (Tick t = front; t < model.ticks; ++t) {
        const Run found = runs.at(t);
        const Run expected = model.run(t);
        REQUIRE(found.value == expected.value);
        REQUIRE(std::max(found.begin, front) == std::max(expected.begin, front));
        REQUIRE(found.end == expected.end);
        t = std::min(found.end, model.ticks);
    }
}

void check_changes(std::uint32_t seed, Tick ticks, int values, int steps) {
    CAPTURE(seed);
    Random random(seed);
    Runs runs(0, 0.0);
    Model model{ticks};
    Tick front = 0;
    for (Tick t = 0; t < ticks && values > 100; ++t) { // many chunks from the start
        const auto value = static_cast<double>(random.between(0, values));
        runs.set(t, t, value);
        model.values[static_cast<std::size_t>(t)] = value;
    }
    for (int i = 0; i < steps; ++i) {
        const Tick t = random.between(front, ticks - 1);
        const Run run = model.run(t);
        const Tick l = random.between(std::max(run.begin, front), t);
        const Tick r = std::min<Tick>({run.end, ticks - 1, t + random.between(0, 4)});
        const auto value = static_cast<double>(random.between(0, values));
        runs.set(l, r, value);
        for (Tick k = l; k <= r; ++k)
            model.values[static_cast<std::size_t>(k)] = value;
        if (random.chance(10)) { // a range of whole runs, or any
            Tick begin = random.between(front, ticks - 1);
            Tick end = std::min(ticks - 1, begin + random.between(0, ticks / 2));
            if (random.chance(80)) {
                begin = std::max(front, model.run(begin).begin);
                end = std::min(ticks - 1, model.run(end).end);
            }
            check_raise(runs, model, front, begin, end,
                        static_cast<double>(random.between(0, values)) / 2);
        }
        if (random.chance(5)) {
            const Tick drop =
                random.between(front, std::min<Tick>(front + 9 * ticks / 400, ticks / 2));
            runs.drop_before(drop);
            front = std::max(front, drop);
            REQUIRE(runs.front() <= drop);
        }
        if (random.chance(3)) {
            rtamt::Snapshot written;
            runs.transfer(written);
            rtamt::Snapshot read(written.bytes());
            Runs other;
            other.transfer(read);
            read.end();
            runs = other;
        }
        const Tick from = random.between(front, ticks - 1);
        const Tick to = random.between(from, ticks - 1);
        const Run found = runs.at(from);
        const Run expected = model.run(from);
        REQUIRE(std::max(found.begin, front) == std::max(expected.begin, front));
        REQUIRE(found.end == expected.end);
        REQUIRE(found.value == expected.value);
        double least = rtamt::infinity;
        double most = -rtamt::infinity;
        for (Tick k = from; k <= to; ++k) {
            least = std::min(least, model.at(k));
            most = std::max(most, model.at(k));
        }
        REQUIRE(runs.least(from, to) == least);
        REQUIRE(runs.most(from, to) == most);
        check_search<Below>(runs, model, from, to, value);
        check_search<Above>(runs, model, from, to, value);
        check_search<AtMost>(runs, model, from, to, value);
        check_search<AtLeast>(runs, model, from, to, value);
    }
}

// Values in the order of time: those of single ticks, or raised from the end on.
void check_order(std::uint32_t seed, int values, Tick span) {
    CAPTURE(seed);
    constexpr Tick ticks = 600;
    Random random(seed);
    Runs singles;
    Runs raised;
    std::vector<double> model(ticks, -rtamt::infinity);
    std::size_t in_place = 0;
    Tick dropped = 0;
    for (Tick t = 0; t < ticks; ++t) {
        const auto value = static_cast<double>(random.between(0, values));
        REQUIRE(singles.last_run().begin <= t);
        if (singles.last_run().begin == t && random.chance(90)) {
            singles.extend(value);
        } else {
            singles.set(t, t, value);
        }
        REQUIRE(singles.at(t).value == value);
        REQUIRE(singles.last_run().begin == t + 1);

        const Tick l = std::max<Tick>(0, t - span);
        std::vector<double> before(model.begin() + l, model.begin() + t + 1);
        const bool done = raised.raise_end(l, t, value, [&](const Run& run) {
            for (Tick k = run.begin; k <= run.end; ++k) {
                REQUIRE(before[static_cast<std::size_t>(k - l)] == run.value);
                REQUIRE(run.value < value);
                before[static_cast<std::size_t>(k - l)] = value;
            }
        });
        in_place += done ? 1 : 0;
        for (Tick k = l; k <= t; ++k) {
            double& each = model[static_cast<std::size_t>(k)];
            each = std::max(each, value);
            if (done) REQUIRE(before[static_cast<std::size_t>(k - l)] == each);
        }
        while (const auto run = raised.first<Below>(l, t, value)) {
            REQUIRE(!done);
            raised.set(run->begin, run->end, value);
        }
        for (Tick k = std::max(dropped, l - 3); k <= t; ++k)
            REQUIRE(raised.at(k).value == model[static_cast<std::size_t>(k)]);
        REQUIRE(raised.last_run().begin == t + 1);
        REQUIRE(raised.last_run().value == -rtamt::infinity);
        if (random.chance(5)) {
            singles.drop_before(l);
            raised.drop_before(l);
            dropped = l;
        }
        REQUIRE(raised.least(l, t) == model[static_cast<std::size_t>(t)]);
        REQUIRE(raised.most(l, t) == model[static_cast<std::size_t>(l)]);
    }
    CHECK(2 * in_place > static_cast<std::size_t>(ticks));
}

// Values raised before the last run too, wherever those before them never rise.
void check_raised(std::uint32_t seed, int values) {
    CAPTURE(seed);
    constexpr Tick ticks = 300;
    Random random(seed);
    Runs runs;
    std::vector<double> model(ticks + 1, -rtamt::infinity);
    std::size_t in_place = 0;
    std::size_t calls = 0;
    for (Tick newest = 0; newest < ticks; newest += random.between(0, 2)) {
        const Tick r = std::max<Tick>(0, newest - random.between(0, 8));
        Tick l = r; // values do not rise from here on
        while (l > 0 && r - l < 40 && random.chance(95) &&
               model[static_cast<std::size_t>(l - 1)] >= model[static_cast<std::size_t>(l)])
            --l;
        const auto value = static_cast<double>(random.between(0, values));
        const std::vector<double> before = model;
        Tick next = l;
        const bool done = runs.raise_end(l, r, value, [&](const Run& run) {
            REQUIRE(next <= run.begin);
            REQUIRE(run.end <= r);
            for (Tick k = run.begin; k <= run.end; ++k) {
                REQUIRE(model[static_cast<std::size_t>(k)] == run.value);
                REQUIRE(run.value < value);
                model[static_cast<std::size_t>(k)] = value;
            }
            next = run.end + 1;
        });
        REQUIRE((done || model == before));
        while (const auto run = runs.first<Below>(l, r, value)) {
            REQUIRE(!done);
            runs.set(run->begin, run->end, value);
            for (Tick k = run->begin; k <= run->end; ++k)
                model[static_cast<std::size_t>(k)] = value;
        }
        for (Tick k = 0; k <= newest + 1; ++k) {
            const Run run = runs.at(k);
            REQUIRE(run.value == model[static_cast<std::size_t>(k)]);
            if (run.begin > 0) REQUIRE(runs.at(run.begin - 1).value != run.value); // maximal
        }
        REQUIRE(runs.least(l, r) == *std::min_element(model.begin() + l, model.begin() + r + 1));
        REQUIRE(runs.most(l, r) == *std::max_element(model.begin() + l, model.begin() + r + 1));
        in_place += done ? 1 : 0;
        ++calls;
    }
    CHECK(4 * in_place > 3 * calls);
}

} // namespace

TEST_CASE("what is raised near the end is that of an array") {
    for (std::uint32_t seed = 0; seed < 40; ++seed)
        check_raised(seed, seed % 2 == 0 ? 3 : 1'000'000);
}

TEST_CASE("what comes in the order of time is that of an array") {
    for (std::uint32_t seed = 0; seed < 20; ++seed)
        check_order(seed, seed % 2 == 0 ? 3 : 1'000'000, seed % 3 == 0 ? 2 : 150);
}

TEST_CASE("runs are those of an array, whatever is set, found and dropped") {
    // Few values join, many make chunks.
    for (std::uint32_t seed = 0; seed < 40; ++seed)
        check_changes(seed, 400, seed % 2 == 0 ? 3 : 40, 600);
}

TEST_CASE("runs in groups of chunks are those of an array") {
    for (std::uint32_t seed = 0; seed < 6; ++seed)
        check_changes(seed, 9000, 1'000'000, 300);
}

TEST_CASE("forever stays what it is") {
    CHECK(plus(forever, -5) == forever);
    CHECK(plus(-forever, 5) == -forever);
    CHECK(plus(3, 4) == 7);
}
