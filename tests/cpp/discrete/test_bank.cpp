#include "discrete/bank.hpp"

#include "check.hpp"

#include <vector>

using rtamt::discrete::Bank;

TEST_CASE("registers keep their last slot when they grow") {
    Bank<double> bank;
    const auto a = bank.add();
    const auto c = bank.add();
    bank.fill(c, 7.5);
    bank.settle(1);
    *bank.at(a) = 3.0;
    CHECK((*bank.at(c) == 7.5 && bank.bytes() == 16));
    bank.grow(10, 0);
    bank.settle(9);
    CHECK((bank.at(a)[0] == 3.0 && bank.at(c) - bank.at(a) == 10));
    for (std::size_t i = 0; i < 9; ++i)
        CHECK(bank.at(c)[i] == 7.5);
}

TEST_CASE("some registers are shorter than the others") {
    Bank<double> bank;
    const auto a = bank.add();
    const auto b = bank.add();
    const auto c = bank.add();
    bank.fill(c, 7.5);
    const std::vector<std::uint32_t> rows{b};
    bank.arrange(10, rows, 4);
    bank.settle(9);
    CHECK((bank.at(b) - bank.at(a) == 10 && bank.at(c) - bank.at(b) == 4));
    CHECK((bank.bytes() == 24 * sizeof(double) && bank.at(c)[8] == 7.5));
}

TEST_CASE("samples go to the registers of their inputs") {
    Bank<double> bank;
    const auto b = bank.add();
    const auto a = bank.add();
    bank.take_input(b, 5, 1);
    bank.take_input(a, 6, 0);
    bank.settle(1);
    const std::vector<double> row{1.0, 2.0};
    bank.load(row.data());
    CHECK((*bank.at(a) == 1.0 && *bank.at(b) == 2.0));
    bank.grow(4, 0);
    bank.settle(4);
    const std::vector<double> first{1, 2, 3, 4};
    const std::vector<double> second{5, 6, 7, 8};
    const std::vector<const double*> columns{first.data(), second.data()};
    bank.load(std::span(columns), 1, 3, [](std::uint32_t input) { return input == 6; });
    CHECK((bank.at(b)[0] == 6 && bank.at(b)[2] == 8));
    CHECK(bank.at(a)[0] == 1.0); // skipped
}

TEST_CASE("rollback restores the last slot of protected registers") {
    Bank<double> bank;
    const auto a = bank.add();
    const auto b = bank.add();
    bank.protect(a);
    bank.settle(1);
    *bank.at(a) = 1.0;
    *bank.at(b) = 1.0;
    bank.checkpoint(0);
    *bank.at(a) = 2.0;
    *bank.at(b) = 2.0;
    bank.rollback(0);
    CHECK((*bank.at(a) == 1.0 && *bank.at(b) == 2.0));
}
