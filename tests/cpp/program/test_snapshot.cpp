#include "program/snapshot.hpp"

#include "check.hpp"

#include <cstdint>
#include <stdexcept>
#include <vector>

using rtamt::Snapshot;

static constexpr const char* foreign = "This is not the state of a monitor of this program.";

static void transfer(Snapshot& snapshot, double& number, bool& flag, std::vector<double>& cells) {
    snapshot.item(number);
    snapshot.item(flag);
    snapshot.values(cells.data(), cells.size());
}

static std::vector<std::uint8_t> written() {
    Snapshot snapshot;
    CHECK(!snapshot.loading());
    double number = 2.5;
    bool flag = true;
    std::vector<double> cells{1.0, 2.0, 3.0};
    transfer(snapshot, number, flag, cells);
    return snapshot.bytes();
}

static void read(const std::vector<std::uint8_t>& bytes, std::size_t count) {
    double number = 0.0;
    bool flag = false;
    std::vector<double> cells(count);
    Snapshot snapshot(bytes);
    transfer(snapshot, number, flag, cells);
    snapshot.end();
    CHECK((snapshot.loading() && number == 2.5 && flag));
    CHECK((cells == std::vector<double>{1.0, 2.0, 3.0}));
}

TEST_CASE("what was written is read") {
    read(written(), 3);
}

TEST_CASE("what is too short or too long is no state of this program") {
    for (const std::size_t count : {std::size_t{0}, std::size_t{2}, std::size_t{4}}) {
        CHECK(thrown<std::invalid_argument>([&] { read(written(), count); }) == foreign);
    }
    CHECK(thrown<std::invalid_argument>([] { read({}, 3); }) == foreign);
}

TEST_CASE("a state of another layout is refused") {
    auto bytes = written();
    ++bytes.front();
    CHECK(thrown<std::invalid_argument>([&] { read(bytes, 3); }) == foreign);
}
