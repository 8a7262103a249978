#include "early/samples.hpp"

#include "check.hpp"
#include "oracle.hpp"
#include "program/snapshot.hpp"

#include <array>
#include <map>

using namespace early_oracle;
using rtamt::early::BoundsEngine;
using rtamt::early::Samples;

namespace {

constexpr Bounds range{-20, 20};
constexpr Tick last_tick = 60;

// All samples that came, and what they make known at a tick by definition.
struct Model {
    explicit Model(bool ordered) : in_order(ordered) {}

    bool in_order;
    std::array<std::map<Tick, Bounds>, 2> inputs;
    Tick closed = -1000;

    [[nodiscard]] Tick until(std::size_t input) const {
        const auto& column = inputs[input];
        if (!in_order || column.empty()) return closed;
        return std::max(closed, column.rbegin()->first);
    }
    [[nodiscard]] std::optional<Tick> start() const {
        Tick start = -1000;
        for (std::size_t i = 0; i < 2; ++i) {
            if (inputs[i].empty() || inputs[i].begin()->first - 1 > until(i)) return std::nullopt;
            start = std::max(start, inputs[i].begin()->first);
        }
        return start;
    }
    [[nodiscard]] Bounds known(std::size_t input, Tick t) const {
        const auto after = inputs[input].upper_bound(t);
        if (after == inputs[input].begin()) return range;
        const auto& [time, bounds] = *std::prev(after);
        return time == t || t <= until(input) ? bounds : range;
    }
};

// Tells an engine that keeps nothing but knowledge.
BoundsEngine knowledge() {
    Graph graph;
    graph.inputs = 2;
    return {graph, {range, range}, BoundsEngine::Arrival::pieces};
}

void check_same(Samples& samples, BoundsEngine& engine, const Model& model) {
    std::vector<BoundsEngine::Observation> observations;
    samples.collect(observations);
    REQUIRE(samples.start() == model.start());
    if (!model.start()) {
        REQUIRE(observations.empty());
        return;
    }
    for (const auto& observation : observations) {
        const Bounds before = engine.known(observation.input, observation.l);
        REQUIRE(before.lower <= observation.bounds.lower);
        REQUIRE(observation.bounds.upper <= before.upper);
    }
    REQUIRE(!engine.learn(observations, *samples.newest() - *samples.start()));
    for (std::uint32_t input = 0; input < 2; ++input) {
        for (Tick t = *model.start(); t < last_tick + 20; ++t) {
            REQUIRE(engine.known(input, t - *model.start()) == model.known(input, t));
        }
        REQUIRE(samples.settled()[input] + *model.start() ==
                std::max(model.until(input), *model.start() - 1));
    }
}

} // namespace

TEST_CASE("samples make known what the definition says, in order or late") {
    for (std::uint32_t seed = 0; seed < 400; ++seed) {
        CAPTURE(seed);
        Random random(seed);
        const bool ordered = random.chance(50);
        const Tick lateness = random.between(0, 12);
        Samples samples({range, range}, ordered ? std::nullopt : std::optional(lateness));
        Model model(ordered);
        BoundsEngine engine = knowledge();
        Tick newest = -20;
        for (int i = 0; i < 40; ++i) {
            const auto input = static_cast<std::uint32_t>(random.between(0, 1));
            const double x = random.number(0);
            Tick time = std::max<Tick>(newest, -5) + random.between(-8, 4);
            if (ordered && random.chance(80) && !model.inputs[input].empty()) {
                time = model.inputs[input].rbegin()->first + random.between(1, 4);
            }
            const auto& column = model.inputs[input];
            const bool may_come = time > model.closed &&
                                  (!ordered || column.empty() || time > column.rbegin()->first);
            REQUIRE(samples.may_come(input, time) == may_come);
            if (random.chance(10)) {
                const Tick mark = std::max<Tick>(newest, -5) - random.between(0, 6);
                samples.close(mark);
                model.closed = std::max(model.closed, mark);
            } else if (may_come && time <= last_tick) {
                const auto before = column.find(time);
                Bounds bounds = random.chance(30) ? range : Bounds{x, x + 1};
                if (before != column.end()) { // only more precise
                    bounds = before->second;
                    if (bounds.lower < bounds.upper) bounds.upper = bounds.lower;
                }
                if (random.chance(20)) { // an update that fails
                    std::vector<BoundsEngine::Observation> observations;
                    samples.add(input, time, bounds);
                    samples.collect(observations);
                    samples.rollback();
                    REQUIRE(samples.may_come(input, time));
                }
                samples.add(input, time, bounds);
                model.inputs[input][time] = bounds;
                newest = std::max(newest, time);
                if (!ordered) model.closed = std::max(model.closed, newest - lateness - 1);
            }
            REQUIRE(samples.known(input, newest) == model.known(input, newest));
            if (!ordered && samples.start() && random.chance(40)) { // nobody asks
                std::vector<BoundsEngine::Observation> observations;
                samples.collect_closed(observations);
                REQUIRE(!engine.learn(observations, newest - *samples.start()));
                for (const auto& each : observations)
                    REQUIRE(each.r + *samples.start() <= model.closed);
                samples.postpone();
                continue;
            }
            check_same(samples, engine, model);
            samples.commit();
            if (random.chance(20)) {
                rtamt::Snapshot written;
                samples.transfer(written);
                Samples other({range, range}, ordered ? std::nullopt : std::optional(lateness));
                rtamt::Snapshot read(written.bytes());
                other.transfer(read);
                read.end();
                samples = other;
            }
        }
        if (!model.start()) continue;
        samples.finish();
        model.closed = 1000;
        std::vector<BoundsEngine::Observation> observations;
        samples.collect(observations);
        REQUIRE(!engine.learn(observations, *samples.newest() - *samples.start()));
        for (std::uint32_t input = 0; input < 2; ++input) {
            for (Tick t = *model.start(); t < last_tick + 20; ++t)
                REQUIRE(engine.known(input, t - *model.start()) == model.known(input, t));
        }
    }
}

TEST_CASE("samples that are final are dropped") {
    Samples samples({range}, std::nullopt);
    for (Tick t = 0; t < 1000; ++t) {
        std::vector<BoundsEngine::Observation> observations;
        samples.add(0, t, Interval::of(1));
        samples.collect(observations);
        samples.commit();
    }
    CHECK(samples.bytes() <= 200);
}

TEST_CASE("samples that nobody asks for are dropped once they are final") {
    Samples samples({range}, 10);
    for (Tick t = 0; t < 10'000; ++t) {
        std::vector<BoundsEngine::Observation> observations;
        samples.add(0, t + 3 - (2 * (t % 4)), Interval::of(1));
        samples.collect_closed(observations);
        samples.start() ? samples.postpone() : samples.commit();
    }
    CHECK(samples.bytes() <= 5'000);
}

TEST_CASE("times far from zero are taken, and too long traces are not") {
    constexpr Tick epoch = 1'763'790'000'000'000'000; // nanoseconds since 1970
    Samples samples({range}, 5);
    REQUIRE(samples.may_come(0, epoch));
    samples.add(0, epoch, range);
    samples.add(0, epoch + 10, range);
    std::vector<BoundsEngine::Observation> observations;
    samples.collect(observations);
    samples.commit();
    REQUIRE(samples.start() == epoch);
    CHECK(samples.settled()[0] == 4);
    CHECK_FALSE(samples.may_come(0, epoch + Samples::longest));
    CHECK_FALSE(samples.may_come(0, Samples::farthest));
    CHECK_FALSE(samples.may_come(0, epoch + 4));
    CHECK(samples.may_come(0, epoch + 5));
}
