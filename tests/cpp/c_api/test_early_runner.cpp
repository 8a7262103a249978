#include "c_api/early_runner.hpp"

#include "check.hpp"
#include "programs.hpp"

#include <array>
#include <limits>
#include <string>

using rtamt::c_api::EarlyGraph;
using rtamt::c_api::EarlyRunner;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::uint32_t none = rtamt::no_operand;

// always(x), of which robustness and truth are alike.
std::string always() {
    std::vector<std::uint8_t> bytes;
    const auto number = [&](std::uint32_t value) { programs::put(bytes, value); };
    const auto tick = [&](std::uint64_t value) { programs::put(bytes, value); };
    for (const std::uint32_t count : {1U, 2U, 1U})
        number(count);
    for (const std::uint32_t field : {0U, none, none})
        number(field);
    for (int i = 0; i < 3; ++i)
        tick(0);
    for (const std::uint32_t field : {1U, 0U, 0U, none})
        number(field);
    tick(0);
    for (int item = 0; item < 2; ++item) {
        for (const std::uint32_t field : {1U, 0U, 0U, none, none})
            number(field);
        tick(0);
    }
    return {bytes.begin(), bytes.end()};
}

rtamt::Program four_outputs() {
    programs::Builder builder;
    const auto x = builder.input();
    for (int i = 0; i < 4; ++i)
        builder.output(x);
    return builder.program();
}

} // namespace

TEST_CASE("bounds at the start narrow, and the verdict is known once it is decided") {
    EarlyRunner runner(four_outputs(), 0.5, EarlyGraph::parse(always(), 1));
    std::array<rtamt_value, 4> known{};
    double row = 3.0;
    runner.step(&row, known);
    CHECK((known[0].value == -infinity && known[1].value == 3.0 && known[2].known == 0));
    row = -1.0;
    runner.step(&row, known);
    CHECK((known[1].value == -1.0 && known[2].value == -infinity && known[3].value == 0.5));
    runner.finish();
    CHECK((runner.last_output(0).count == 1 && runner.last_output(0).values[0] == -1.0));
    runner.reset();
    CHECK((!runner.begun() && !runner.finished() && runner.samples() == 0));
}

TEST_CASE("a graph that is cut off or too long is refused") {
    const std::string whole = always();
    for (std::size_t size = 0; size < whole.size(); ++size) {
        CHECK_THROWS_AS((void)EarlyGraph::parse(whole.substr(0, size), 1), std::invalid_argument);
    }
    CHECK_THROWS_AS((void)EarlyGraph::parse(whole + "x", 1), std::invalid_argument);
    CHECK_THROWS_AS((void)EarlyGraph::parse(whole, 0), std::invalid_argument);
}
