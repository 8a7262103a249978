#include "bounds_at_start.hpp"

#include "state_checks.hpp"

#include <algorithm>
#include <map>
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

[[nodiscard]] bool is_pair(const Item& item) noexcept {
    return item.kind == Item::Kind::both || item.kind == Item::Kind::either;
}

// The item of a reference at the start. What a pair connects are references yet.
[[nodiscard]] Item item_of(const Graph& graph, std::uint32_t ref) {
    const Node& node = graph.nodes[ref / 2];
    const bool flipped = (ref & 1U) != 0;
    switch (node.kind) {
    case Kind::both:
    case Kind::either: {
        const auto kind = node.kind == Kind::both ? Item::Kind::both : Item::Kind::either;
        return {kind, flipped, node.a, node.b};
    }
    case Kind::least:
    case Kind::greatest: {
        if (node.low < 0 || node.high >= forever) break;
        const auto kind = node.kind == Kind::least ? Item::Kind::all : Item::Kind::some;
        return {kind, flipped, node.a, none, none, node.low, node.high};
    }
    case Kind::until:
        return {Item::Kind::until, flipped, ref & ~1U, node.a, node.b};
    default:
        break;
    }
    return {Item::Kind::value, false, ref};
}

// Of until over the ticks from `t` up to, and without, `end`: the best so far, and how far hold
// goes.
struct Reached {
    double best;
    double held;

    void pass(const BoundsEngine& engine, const Item& item, int reg, Tick t, Tick end) noexcept {
        const bool greatest = up(item, reg);
        const Runs& holds = engine.runs(item.b, reg);
        const Runs& goals = engine.runs(item.c, reg);
        while (t < end) {
            const Run hold = holds.at(t);
            const Run goal = goals.at(t);
            best = join(greatest, best, join(!greatest, held, goal.value));
            held = join(!greatest, held, hold.value);
            t = std::min(hold.end, goal.end) + 1;
        }
    }
};

} // namespace

BoundsAtStart::BoundsAtStart(std::vector<Item> items, const BoundsEngine& engine,
                             std::span<const std::uint32_t> outputs, Use use)
    : items_(std::move(items)), formula_(items_.size() - 1), use_(use) {
    check(items_, engine.size());
    if (use_ != Use::as_given && !items_.empty()) put_together(engine.graph(), outputs);
    find_folds(engine.graph());
    states_.resize(items_.size());
    for (std::size_t i = 0; i < items_.size(); ++i) {
        State& state = states_[i];
        state.next = items_[i].tick;
        for (int reg = 0; reg < 2; ++reg) {
            const auto r = static_cast<std::size_t>(reg);
            state.best[r] = up(items_[i], reg) ? -infinity : infinity;
            state.held[r] = -state.best[r];
            const auto kind = items_[i].kind;
            if (up(items_[i], reg) && (kind == Item::Kind::all || kind == Item::Kind::some))
                state.value[r] = engine.runs(items_[i].a, reg).most(state.next, items_[i].last);
        }
    }
    read(engine);
}

void BoundsAtStart::check(std::span<const Item> items, std::size_t nodes) {
    for (std::size_t i = 0; i < items.size(); ++i) {
        const Item& item = items[i];
        const bool fits = is_pair(item) ? item.a < i && item.b < i : item.a / 2 < nodes;
        if (!fits || item.tick < 0 || item.tick >= forever) {
            throw std::invalid_argument("This is no formula at the start of a trace.");
        }
    }
}

// Items of values become items of what these are made of, those of operands first. What the formula
// does not need is left out.
void BoundsAtStart::put_together(const Graph& graph, std::span<const std::uint32_t> outputs) {
    const auto is_made = [&](const Item& item) {
        return item.kind == Item::Kind::value && item.tick == 0 &&
               std::ranges::none_of(outputs, [&](auto ref) { return ref / 2 == item.a / 2; });
    };
    const auto ref_of = [](const Item& item) {
        return item.a ^ static_cast<std::uint32_t>(item.negated);
    };
    std::vector<bool> needed(items_.size());
    std::map<std::uint32_t, Tick> settled; // by reference
    const auto need = [&](std::uint32_t ref, Tick tick) {
        Tick& known = settled.try_emplace(ref, 0).first->second;
        known = std::max(known, std::min(tick, graph.nodes[ref / 2].horizon));
    };
    needed.back() = true;
    for (std::size_t i = items_.size(); i-- > 0;) {
        const Item& item = items_[i];
        if (needed[i] && is_pair(item)) needed[item.a] = needed[item.b] = true;
        if (needed[i] && is_made(item)) need(ref_of(item), forever);
    }
    for (auto it = settled.end(); it != settled.begin();) { // operands come before
        --it;
        const Item item = item_of(graph, it->first);
        if (!is_pair(item)) continue;
        need(item.a, it->second);
        need(item.b, it->second);
    }
    std::vector<Item> result;
    const auto add = [&](const Item& item) {
        result.push_back(item);
        return static_cast<std::uint32_t>(result.size() - 1);
    };
    std::map<std::uint32_t, std::uint32_t> places; // of references
    for (const auto& [ref, tick] : settled) {
        Item item = item_of(graph, ref);
        item.settled = tick;
        if (is_pair(item)) {
            item.a = places.at(item.a);
            item.b = places.at(item.b);
        }
        places[ref] = add(item);
    }
    std::vector<std::uint32_t> moved(items_.size(), none); // the places of the items given
    for (std::size_t i = 0; i < items_.size(); ++i) {
        Item item = items_[i];
        if (!needed[i]) continue;
        if (is_pair(item)) {
            item.a = moved[item.a];
            item.b = moved[item.b];
        }
        moved[i] = is_made(item) ? places.at(ref_of(item)) : add(item);
    }
    items_ = std::move(result);
    formula_ = moved.back();
}

// What is final at each sample, and the same from the newest one on, are predicates and their
// combinations at one instant.
void BoundsAtStart::find_folds(const Graph& graph) {
    std::vector<bool> instant;
    const auto at_one = [&](std::uint32_t ref) { return ref == none || instant[ref / 2]; };
    for (const Node& node : graph.nodes) {
        const bool pointwise =
            node.kind == Kind::both || node.kind == Kind::either || node.kind == Kind::map;
        instant.push_back(node.kind == Kind::atom ||
                          (pointwise && at_one(node.a) && at_one(node.b)));
    }
    for (const Item& item : items_) {
        folds_.push_back(use_ == Use::in_order && item.kind == Item::Kind::until &&
                         at_one(item.b) && at_one(item.c));
    }
}

Bounds BoundsAtStart::bounds_of(std::size_t item) const noexcept {
    const auto& value = states_[item].value;
    const Bounds bounds{value[0], -value[1]};
    return items_[item].negated ? Interval::neg(bounds) : bounds;
}

void BoundsAtStart::limit(std::span<Tick> last) const noexcept {
    const auto reads = [&](std::uint32_t ref, Tick tick) {
        last[ref / 2] = std::max(last[ref / 2], tick);
    };
    for (std::size_t i = 0; i < items_.size(); ++i) {
        const Item& item = items_[i];
        if (is_pair(item)) continue;
        if (folds_[i]) {
            reads(item.b, item.last);
            reads(item.c, item.last);
        } else {
            reads(item.a, item.kind == Item::Kind::value ? item.tick : item.last);
        }
    }
}

std::vector<std::uint32_t> BoundsAtStart::read_forever() const {
    std::vector<std::uint32_t> refs;
    for (const Item& item : items_) {
        if (item.settled < forever) continue;
        if (item.kind == Item::Kind::all || item.kind == Item::Kind::some) refs.push_back(item.a);
        if (item.kind == Item::Kind::until) refs.insert(refs.end(), {item.a, item.b, item.c});
    }
    return refs;
}

void BoundsAtStart::read(const BoundsEngine& engine, Tick closed) {
    for (std::size_t i = 0; i < items_.size(); ++i) {
        const Item& item = items_[i];
        State& state = states_[i];
        if (is_pair(item)) {
            const Bounds value =
                join(item.kind == Item::Kind::either, bounds_of(item.a), bounds_of(item.b));
            state.value = {value.lower, -value.upper};
        } else if (state.next < forever) {
            if (folds_[i] && closed >= state.next) {
                fold(engine, i, closed + 1);
                state.next = closed + 1;
            }
            for (int reg = 0; reg < 2; ++reg) {
                double& value = state.value[static_cast<std::size_t>(reg)];
                value = Real::join(value, seen(engine, i, reg)); // bounds only narrow
            }
        }
    }
}

// A register of an item by what is known now, where that may be above its value.
double BoundsAtStart::seen(const BoundsEngine& engine, std::size_t index, int reg) const noexcept {
    const Item& item = items_[index];
    const State& state = states_[index];
    const auto r = static_cast<std::size_t>(reg);
    if (folds_[index]) {
        Reached reached{state.best[r], state.held[r]};
        reached.pass(engine, item, reg, state.next, forever);
        return reached.best;
    }
    const Runs& runs = engine.runs(item.a, reg);
    const auto& pieces = engine.new_data(item.a, reg);
    const double value = state.value[r];
    const bool greatest = up(item, reg);
    switch (item.kind) {
    case Item::Kind::all:
    case Item::Kind::some:
        break;
    case Item::Kind::until:
        return join(greatest, state.best[r],
                    join(!greatest, state.held[r], runs.at(state.next).value));
    default:
        return runs.at(state.next).value;
    }
    if (greatest) {
        double now = value;
        for (const Piece& piece : pieces) {
            if (piece.r >= item.tick && piece.l <= item.last) now = Real::join(now, piece.now);
        }
        return now;
    }
    // The least can rise only where it was itself.
    const auto was_least = [&](const Piece& piece) { return piece.old <= value; };
    if (value > -infinity && std::ranges::none_of(pieces, was_least)) return value;
    return Real::meet(state.best[r], runs.least(state.next, item.last, value));
}

void BoundsAtStart::settle(const BoundsEngine& engine, Tick closed, std::span<Tick> wanted) {
    for (std::size_t i = 0; i < items_.size(); ++i) {
        const Item& item = items_[i];
        State& state = states_[i];
        if (is_pair(item)) continue;
        Tick horizon = engine.horizon(item.a);
        if (item.kind == Item::Kind::until) {
            horizon = std::max(engine.horizon(item.b), engine.horizon(item.c));
        }
        const Tick open = plus(plus(closed, 1), -horizon);
        const Tick last = item.kind == Item::Kind::value ? item.tick : item.last;
        if (open > last || closed >= item.settled) {
            state.next = forever;
        } else if (item.kind != Item::Kind::value && open > state.next) {
            fold(engine, i, open);
            state.next = open;
        }
        if (use_ != Use::as_given && decided(i)) state.next = forever;
        const auto wants = [&](std::uint32_t ref) {
            wanted[ref / 2] = std::min(wanted[ref / 2], state.next);
        };
        if (folds_[i]) {
            wants(item.b);
            wants(item.c);
        } else {
            wants(item.a);
        }
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
        if (item.kind == Item::Kind::until) {
            Reached reached{best, state.held[r]};
            reached.pass(engine, item, reg, state.next, end);
            best = reached.best;
            state.held[r] = reached.held;
        } else {
            const Runs& runs = engine.runs(item.a, reg);
            best =
                join(greatest, best,
                     greatest ? runs.most(state.next, end - 1) : runs.least(state.next, end - 1));
        }
    }
}

Bounds BoundsAtStart::ended(const BoundsEngine& engine, Tick end) const {
    std::vector<std::uint32_t> refs;
    refs.reserve(items_.size());
    for (const Item& item : items_)
        refs.push_back(is_pair(item) ? 0 : item.a);
    const auto rests = engine.ended(refs, end);
    std::vector<Bounds> values(items_.size());
    for (std::size_t i = 0; i < items_.size(); ++i) {
        const Item& item = items_[i];
        const State& state = states_[i];
        Bounds value{state.value[0], -state.value[1]};
        if (is_pair(item)) {
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
                for (Tick t = from; t < end && t <= item.last; ++t)
                    value = join(item.kind == Item::Kind::some, value, at(t));
            }
        }
        values[i] = item.negated ? Interval::neg(value) : value;
    }
    return values[formula_];
}

void BoundsAtStart::transfer(Snapshot& snapshot) {
    for (State& state : states_) {
        for (std::size_t reg = 0; reg < 2; ++reg) {
            checked::number(snapshot, state.value[reg]);
            checked::number(snapshot, state.best[reg]);
            checked::number(snapshot, state.held[reg]);
        }
        checked::tick_or_forever(snapshot, state.next);
    }
}

} // namespace rtamt::early
