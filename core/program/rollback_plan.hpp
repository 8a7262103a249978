// In which order kernels run so that a failed update leaves no trace.
//
// The *guarded* group is every instruction that can fail and everything such an instruction is
// computed from (Program::guarded); the rest cannot fail. An update runs the guarded group first;
// when a value of it is undefined, the group is taken back to where it was, and the rest has not
// moved. A dry run does the same for a longer stretch, whatever comes of it.
//
// A unit is a kernel with what an executor needs to know of it. Failures are ordered by a place,
// a slot of a block or a time, and then by instruction: of all undefined values the first one is
// reported, since the others can only follow from it.
//
// Cost: that of the kernels. Memory: two words a kernel.
#pragma once

#include <optional>
#include <utility>
#include <vector>

namespace rtamt {

template <class Unit>
class RollbackPlan {
  public:
    // In the order of the program. `reversible`: checkpoint() and rollback() mean something to it.
    void add(const Unit& unit, bool guarded, bool reversible = true) {
        (guarded ? guarded_ : free_).push_back(unit);
        if (guarded && reversible) reversible_.push_back(unit.kernel);
    }

    // Moves a unit that was added as free to the end of the guarded group.
    void guard(const Unit& unit) {
        std::erase_if(free_, [&](const Unit& other) { return other.kernel == unit.kernel; });
        add(unit, true);
    }

    [[nodiscard]] bool can_fail() const noexcept { return !guarded_.empty(); }

    template <class... Arguments>
    void checkpoint(Arguments... arguments) const noexcept {
        for (auto* kernel : reversible_)
            kernel->checkpoint(arguments...);
    }
    void rollback() const noexcept {
        for (auto* kernel : reversible_)
            kernel->rollback();
    }

    // Runs the guarded group: `run(unit)` returns where its first undefined value is, at `last` or
    // later if nowhere. Returns the first failure.
    template <class Place, class Run>
    [[nodiscard]] std::optional<std::pair<const Unit*, Place>> run_guarded(Place last,
                                                                           Run&& run) const {
        Place first = last;
        const Unit* culprit = nullptr;
        for (const Unit& unit : guarded_) {
            const Place place = run(unit);
            if (place < first) [[unlikely]] {
                first = place;
                culprit = &unit;
            }
        }
        if (culprit == nullptr) [[likely]] {
            return std::nullopt;
        }
        return std::pair(culprit, first);
    }

    template <class Run>
    void run_free(Run&& run) const {
        for (const Unit& unit : free_)
            run(unit);
    }

    // Lets `trial` run the guarded group and rolls it back; returns the result of `trial`.
    template <class Trial, class... Arguments>
    [[nodiscard]] bool dry_run(Trial&& trial, Arguments... arguments) const {
        checkpoint(arguments...);
        const bool valid = trial();
        rollback();
        return valid;
    }

    // All units, the guarded ones first.
    template <class Visit>
    void each(Visit&& visit) const {
        for (const auto* units : {&guarded_, &free_}) {
            for (const Unit& unit : *units)
                visit(unit);
        }
    }

  private:
    using Kernel = decltype(Unit::kernel);

    std::vector<Unit> guarded_;
    std::vector<Unit> free_;
    std::vector<Kernel> reversible_;
};

} // namespace rtamt
