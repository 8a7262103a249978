#include "bounds_at_start.hpp"

#include "../program/snapshot.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace rtamt::early {

namespace {

// Whether a register of an item takes the greatest.
[[nodiscard]] bool up(const Item& item, int reg) noexcept {
    return (item.kind != Item::Kind::all && item.kind != Item::Kind::both) == (reg == 0);
}

[[nodiscard]] double join(bool greatest, double a, double b) noexcept {
    return greatest ? Real::join(a, b) : Real::meet(a, b);
}

[[nodiscard]] Bounds join(bool greatest, const Bounds& a, const Bounds& b) noexcept {
    return greatest ? Interval::join(a, b) : Interval::meet(a, b);
}

} // namespace

BoundsAtStart::BoundsAtStart(std::vector<Item> items, const BoundsEngine& engine, bool follows)
    : items_(std::move(items)), states_(items_.size()), follows_(follows) {
    for (std::size_t i = 0; i < items_.size(); ++i) {
        const Item& item = items_[i];
        const bool pair = item.kind == Item::Kind::both || item.kind == Item::Kind::either;
        const bool fits = pair ? item.a < i && item.b < i : item.a / 2 < engine.size();
        if (!fits || item.tick < 0 || item.tick >= forever) {
            throw std::invalid_argument("This is no formula at the start of a trace.");
        }
        State& state = states_[i];
        state.next = item.tick;
        for (int reg = 0; reg < 2; ++reg) {
            const auto r = static_cast<std::size_t>(reg);
            state.best[r] = up(item, reg) ? -infinity : infinity;
            state.held[r] = -state.best[r];
        }
    }
    read(engine);
}

Bounds BoundsAtStart::bounds_of(std::size_t item) const noexcept {
    const auto& value = states_[item].value;
    const Bounds bounds{value[0], -value[1]};
    return items_[item].negated ? Interval::neg(bounds) : bounds;
}

void BoundsAtStart::limit(std::span<Tick> last) const noexcept {
    for (const Item& item : items_) {
        if (item.kind == Item::Kind::both || item.kind == Item::Kind::either) continue;
        Tick& of_node = last[item.a / 2];
        of_node = std::max(of_node, item.kind == Item::Kind::value ? item.tick : forever);
    }
}

std::vector<std::uint32_t> BoundsAtStart::read_forever() const {
    std::vector<std::uint32_t> refs;
    for (const Item& item : items_) {
        if (item.kind == Item::Kind::all || item.kind == Item::Kind::some) refs.push_back(item.a);
        if (item.kind == Item::Kind::until) refs.insert(refs.end(), {item.a, item.b, item.c});
    }
    return refs;
}

void BoundsAtStart::read(const BoundsEngine& engine) {
    for (std::size_t i = 0; i < items_.size(); ++i)
        look_at(engine, i);
}

void BoundsAtStart::look_at(const BoundsEngine& engine, std::size_t index) noexcept {
    const Item& item = items_[index];
    State& state = states_[index];
    if (item.kind == Item::Kind::both || item.kind == Item::Kind::either) {
        const Bounds value =
            join(item.kind == Item::Kind::either, bounds_of(item.a), bounds_of(item.b));
        state.value = {value.lower, -value.upper};
        return;
    }
    if (state.next >= forever) return; // it is final
    for (int reg = 0; reg < 2; ++reg) {
        const auto r = static_cast<std::size_t>(reg);
        const Runs& runs = engine.runs(item.a, reg);
        const bool greatest = up(item, reg);
        double now = runs.at(state.next).value;
        if (item.kind == Item::Kind::until) {
            now = join(greatest, state.best[r], join(!greatest, state.held[r], now));
        } else if (item.kind != Item::Kind::value) {
            if (greatest) {
                now = state.value[r];
                for (const Piece& piece : engine.new_data(item.a, reg)) {
                    if (piece.r >= item.tick) now = Real::join(now, piece.now);
                }
                if (engine.new_data(item.a, reg).empty() && now == -infinity) {
                    now = runs.most(state.next, forever);
                }
            } else if (state.value[r] == -infinity || !engine.new_data(item.a, reg).empty()) {
                now = Real::meet(state.best[r], runs.least(state.next, forever));
            } else {
                now = state.value[r];
            }
        }
        state.value[r] = Real::join(state.value[r], now); // bounds only narrow
    }
}

void BoundsAtStart::settle(const BoundsEngine& engine, Tick closed, std::span<Tick> wanted) {
    for (std::size_t i = 0; i < items_.size(); ++i) {
        const Item& item = items_[i];
        State& state = states_[i];
        if (item.kind == Item::Kind::both || item.kind == Item::Kind::either) continue;
        Tick horizon = engine.horizon(item.a);
        if (item.kind == Item::Kind::until) {
            horizon = std::max(engine.horizon(item.b), engine.horizon(item.c));
        }
        const Tick open = plus(plus(closed, 1), -horizon);
        if (item.kind == Item::Kind::value) {
            if (open > item.tick) state.next = forever;
        } else if (state.next < forever && open > state.next) {
            fold(engine, i, open);
            state.next = open;
        }
        if (!follows_ && decided(i)) state.next = forever;
        wanted[item.a / 2] = std::min(wanted[item.a / 2], state.next);
    }
}

// Whether no later tick can change the value, nor the end of the trace: it cuts windows, so that
// bounds which meet are not enough.
bool BoundsAtStart::decided(std::size_t index) const noexcept {
    const State& state = states_[index];
    const Bounds best{state.best[0], -state.best[1]};
    const Bounds held{state.held[0], -state.held[1]};
    switch (items_[index].kind) {
    case Item::Kind::all:
        return best == Interval::bottom;
    case Item::Kind::some:
        return best == Interval::top;
    case Item::Kind::until:
        return best == Interval::top || (held == Interval::bottom && best.lower == best.upper);
    default:
        return false; // settled by its horizon
    }
}

// Ticks up to, and without, `end` are final.
void BoundsAtStart::fold(const BoundsEngine& engine, std::size_t index, Tick end) noexcept {
    const Item& item = items_[index];
    State& state = states_[index];
    for (int reg = 0; reg < 2; ++reg) {
        const auto r = static_cast<std::size_t>(reg);
        const bool greatest = up(item, reg);
        double& best = state.best[r];
        if (item.kind != Item::Kind::until) {
            const Runs& runs = engine.runs(item.a, reg);
            best =
                join(greatest, best,
                     greatest ? runs.most(state.next, end - 1) : runs.least(state.next, end - 1));
            continue;
        }
        for (Tick t = state.next; t < end;) {
            const Run hold = engine.runs(item.b, reg).at(t);
            const Run goal = engine.runs(item.c, reg).at(t);
            best = join(greatest, best, join(!greatest, state.held[r], goal.value));
            state.held[r] = join(!greatest, state.held[r], hold.value);
            t = std::min(hold.end, goal.end) + 1;
        }
    }
}

Bounds BoundsAtStart::ended(const BoundsEngine& engine, Tick end) const {
    std::vector<std::uint32_t> refs;
    refs.reserve(items_.size());
    for (const Item& item : items_)
        refs.push_back(item.kind == Item::Kind::both || item.kind == Item::Kind::either ? 0
                                                                                        : item.a);
    const auto rests = engine.ended(refs, end);
    std::vector<Bounds> values(items_.size());
    for (std::size_t i = 0; i < items_.size(); ++i) {
        const Item& item = items_[i];
        const State& state = states_[i];
        Bounds value{state.value[0], -state.value[1]};
        if (item.kind == Item::Kind::both || item.kind == Item::Kind::either) {
            value = join(item.kind == Item::Kind::either, values[item.a], values[item.b]);
        } else if (state.next < forever) {
            const auto& rest = rests[i];
            const Bounds best{state.best[0], -state.best[1]};
            const Bounds held{state.held[0], -state.held[1]};
            const Tick from = std::max(state.next, rest.first);
            const bool there = from < end;
            const auto at = [&](Tick t) {
                return rest.bounds[static_cast<std::size_t>(t - rest.first)];
            };
            if (item.kind == Item::Kind::value) {
                value = there ? at(from) : value;
            } else if (item.kind == Item::Kind::until) {
                value = there ? Interval::join(best, Interval::meet(held, at(from))) : best;
            } else {
                value = best;
                for (Tick t = from; t < end; ++t)
                    value = join(item.kind == Item::Kind::some, value, at(t));
            }
        }
        values[i] = item.negated ? Interval::neg(value) : value;
    }
    return values.back();
}

void BoundsAtStart::transfer(Snapshot& snapshot) {
    for (State& state : states_) {
        for (std::size_t reg = 0; reg < 2; ++reg) {
            snapshot.item(state.value[reg]);
            snapshot.item(state.best[reg]);
            snapshot.item(state.held[reg]);
        }
        snapshot.item(state.next);
        snapshot.require(state.next >= 0);
    }
}

} // namespace rtamt::early
