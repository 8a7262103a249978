#include "c_api/runner.hpp"

#include "check.hpp"
#include "programs.hpp"

#include <array>
#include <cmath>

using programs::carried;
using rtamt::Domain;
using rtamt::c_api::DenseRunner;
using rtamt::c_api::DiscreteRunner;
using rtamt::c_api::make_runner;
using rtamt::c_api::Undefined;

TEST_CASE("a runner is for the domain of its program") {
    const auto made = [](const rtamt::Program& program) {
        return make_runner(program, rtamt::Metadata::parse(program));
    };
    CHECK(dynamic_cast<DiscreteRunner*>(made(carried()).get()) != nullptr);
    CHECK(dynamic_cast<DenseRunner*>(made(carried(Domain::dense)).get()) != nullptr);
}

TEST_CASE("in discrete time known values follow their lags") {
    DiscreteRunner runner(carried());
    std::array<rtamt_value, 2> known{};
    CHECK((!runner.begun() && !runner.known_until(0) && !runner.known_until(1)));
    for (int i = 0; i < 5; ++i) {
        const std::array<double, 2> row{3.0 + i, 1.0};
        runner.step(row.data(), known);
        CHECK(((known[0].known == 0) == (i < 3) && known[1].value == 3.0 + i));
    }
    CHECK((known[0].value == 2.5 && runner.begun() && runner.samples() == 5));
    CHECK((runner.known_until(0) == 1 && runner.known_until(1) == 4));
    runner.finish();
    CHECK((runner.last_output(0).count == 3 && runner.last_output(0).times[0] == 2 &&
           runner.last_output(1).count == 0));
    CHECK((runner.last_output(0).values[2] == 5.5 && runner.known_until(0) == 4));
    runner.reset();
    CHECK((!runner.begun() && !runner.finished() && runner.last_output(0).count == 0));
}

TEST_CASE("in dense time what is discarded was never there") {
    DenseRunner runner(carried(Domain::dense));
    runner.add(0, 5, 3.0);
    CHECK(runner.last(0) == 5);
    runner.discard();
    CHECK((!runner.last(0) && !runner.begun()));
    runner.add(0, 0, 3.0);
    runner.add(1, 0, 1.0);
    runner.push();
    CHECK((runner.last_output(0).count == 0 && runner.last_output(1).count == 1 && runner.begun()));
    runner.add(0, 4, 4.0);
    runner.add(1, 4, 0.0);
    runner.push();
    CHECK((runner.last_output(0).count == 1 && runner.last_output(0).values[0] == 1.5));
    CHECK((runner.known_until(0) == 1 && runner.known_until(1) == 4));
}
