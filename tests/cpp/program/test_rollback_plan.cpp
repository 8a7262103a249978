#include "program/rollback_plan.hpp"

#include "check.hpp"

#include <string>
#include <vector>

namespace {

struct Kernel {
    int place = 9;
    std::string log;
    void checkpoint(int count) { log += "c" + std::to_string(count); }
    void rollback() { log += 'r'; }
};

struct Unit {
    Kernel* kernel;
    int instruction;
};

using Plan = rtamt::RollbackPlan<Unit>;

const auto place = [](const Unit& unit) { return unit.kernel->place; };

} // namespace

TEST_CASE("the first failure is the earliest and then that of the first instruction") {
    Kernel a;
    Kernel b;
    Kernel c;
    Plan plan;
    CHECK((!plan.can_fail() && !plan.run_guarded(9, place)));
    plan.add({&a, 1}, true);
    plan.add({&b, 2}, true);
    plan.add({&c, 3}, true);
    CHECK((plan.can_fail() && !plan.run_guarded(9, place)));
    b.place = c.place = 4;
    auto failure = plan.run_guarded(9, place);
    CHECK((failure && failure->first->instruction == 2 && failure->second == 4));
    c.place = 3;
    failure = plan.run_guarded(9, place);
    CHECK((failure && failure->first->instruction == 3 && failure->second == 3));
}

TEST_CASE("a dry run takes back the guarded kernels that have state") {
    Kernel free;
    Kernel guarded;
    Kernel stateless;
    Plan plan;
    plan.add({&free, 1}, false);
    plan.add({&guarded, 2}, true);
    plan.add({&stateless, 3}, true, false);
    CHECK((!plan.dry_run([] { return false; }, 5) && plan.dry_run([] { return true; }, 6)));
    CHECK((guarded.log == "c5rc6r" && free.log.empty() && stateless.log.empty()));
}

TEST_CASE("a unit becomes guarded when something that can fail reads it") {
    Kernel a;
    Kernel b;
    Plan plan;
    plan.add({&a, 1}, false);
    plan.add({&b, 2}, false);
    plan.guard({&a, 1});
    std::vector<int> order;
    plan.each([&](const Unit& unit) { order.push_back(unit.instruction); });
    CHECK(((order == std::vector<int>{1, 2}) && plan.can_fail()));
    int free = 0;
    plan.run_free([&](const Unit& unit) { free = unit.instruction; });
    CHECK(free == 2);
}
