#include "causation.hpp"

#include "causation_until.hpp"
#include "state_checks.hpp"

#include <algorithm>
#include <functional>
#include <stdexcept>
#include <utility>

namespace rtamt::early {

namespace {

[[nodiscard]] bool takes_greatest(Cause::Kind kind, int reg) noexcept {
    return (kind == Cause::Kind::either || kind == Cause::Kind::greatest) == (reg == 0);
}

} // namespace

Causes::Causes(CauseGraph graph, const BoundsEngine& engine, const BoundsAtStart& at_start,
               bool dense)
    : causes_(std::move(graph.parts)), outputs_(std::move(graph.outputs)),
      starts_(std::move(graph.starts)), dense_(dense), parts_(causes_.size()),
      known_(outputs_.size()), items_(starts_.size()) {
    check(engine, at_start);
}

void Causes::check(const BoundsEngine& engine, const BoundsAtStart& at_start) {
    const auto require = [](bool holds) {
        if (!holds) throw std::invalid_argument("This is no causation that an engine can compute.");
    };
    const auto earlier = [&](std::uint32_t ref, std::size_t end) { return ref / 2 < end; };
    reach_ = engine.reach();
    for (std::size_t i = 0; i < causes_.size(); ++i) {
        const Cause& cause = causes_[i];
        const bool recursion = cause.kind == Cause::Kind::until || cause.kind == Cause::Kind::since;
        const bool pair =
            recursion || cause.kind == Cause::Kind::both || cause.kind == Cause::Kind::either;
        require(cause.kind <= Cause::Kind::since && cause.ref / 2 < engine.size());
        const bool predicate = cause.kind == Cause::Kind::atom || cause.kind == Cause::Kind::span;
        require(predicate || earlier(cause.a, i));
        require(!pair || earlier(cause.b, i));
        require(!recursion || (cause.core / 2 < engine.size() && cause.low >= 0));
        require(cause.low <= cause.high && cause.shift >= 0 && cause.shift < forever);
        require(cause.kind != Cause::Kind::since || cause.shift == 0); // it looks back anyway
        reach_ = std::min(plus(reach_, cause.shift + 2), forever / 4);
    }
    for (const std::uint32_t output : outputs_)
        require(earlier(output, causes_.size()));
    require(starts_.size() == at_start.size());
    for (std::size_t i = 0; i < starts_.size(); ++i) {
        const StartingCause& start = starts_[i];
        const Item::Kind kind = at_start.item(i).kind;
        for (const std::uint32_t ref : {start.a, start.b})
            require(ref == none || earlier(ref, causes_.size()));
        require(start.b == none || start.a != none);
        require(start.before < i || (start.before == none && start.rest == none));
        require(start.rest == none || (start.rest < i && start.b != none &&
                                       at_start.item(start.rest).kind == Item::Kind::until));
        require(start.a != none || (kind != Item::Kind::all && kind != Item::Kind::some));
    }
}

void Causes::read(const BoundsEngine& engine, const BoundsAtStart& at_start, Tick newest) {
    read(engine, at_start, NewData{.newest = newest, .observations = {}});
}

void Causes::read(const BoundsEngine& engine, const BoundsAtStart& at_start,
                  std::span<const BoundsEngine::Observation> observations) {
    read(engine, at_start, NewData{.newest = 0, .observations = observations});
}

void Causes::read(const BoundsEngine& engine, const BoundsAtStart& at_start,
                  const NewData& new_data) {
    for (std::size_t i = 0; i < causes_.size(); ++i) {
        for (int reg = 0; reg < 2; ++reg)
            compute(engine, i, reg, new_data);
    }
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
        known_[i] = {of(outputs_[i], 0), of(outputs_[i], 1)};
        if (dense_) continue;
        // What is caused where nothing changes any more is from there on; windows that reach beyond
        // the last tick that is computed know less of the ticks before it.
        const Tick settled = plus(new_data.newest, reach_);
        for (Pieces& pieces : known_[i]) {
            while (!pieces.empty() && pieces.back().begin > settled)
                pieces.pop_back();
            if (!pieces.empty() && pieces.back().end >= settled) pieces.back().end = forever;
        }
    }
    for (std::size_t i = 0; i < starts_.size(); ++i) {
        items_[i] = {item(engine, at_start, i, 0), item(engine, at_start, i, 1)};
        if (at_start.item(i).negated) std::swap(items_[i][0], items_[i][1]);
    }
    if (!items_.empty()) start_ = {items_.back()[0], -items_.back()[1]};
}

// Hold from an open tick on: the engine keeps it from there on plus low. Of `since` hold and goal
// in the windows of open ticks: the engine keeps them for as long as each alone may change.
void Causes::settle(const BoundsEngine& engine, Tick closed,
                    std::span<Tick> wanted) const noexcept {
    for (const Cause& cause : causes_) {
        const Tick open = plus(closed + 1, -engine.horizon(cause.ref));
        const auto want = [&](std::uint32_t part, Tick t) {
            Tick& first = wanted[causes_[part / 2].ref / 2];
            first = std::min(first, std::max<Tick>(0, t));
        };
        if (cause.kind == Cause::Kind::until) {
            want(cause.a, plus(open, -cause.shift));
        } else if (cause.kind == Cause::Kind::since && cause.high < forever) {
            want(cause.a, plus(open, -cause.high));
            want(cause.b, plus(open, -cause.high));
        }
    }
}

// The last tick that is computed.
Tick Causes::last(const NewData& new_data) const noexcept {
    return dense_ ? forever : new_data.newest + 2 * reach_;
}

void Causes::compute(const BoundsEngine& engine, std::size_t index, int reg,
                     const NewData& new_data) {
    const Cause& cause = causes_[index];
    Pieces& pieces = parts_[index][static_cast<std::size_t>(reg)];
    const Runs& own = engine.runs(cause.ref, reg);
    const Tick last = this->last(new_data);
    pieces.clear();
    switch (cause.kind) {
    case Cause::Kind::atom:
        if (!dense_)
            append(pieces, new_data.newest, new_data.newest, own.at(new_data.newest).value);
        for (const BoundsEngine::Observation& observation : new_data.observations) {
            if (engine.reads(cause.ref, observation.input))
                append(pieces, own, observation.l, observation.r);
        }
        break;
    case Cause::Kind::span:
        for (const Piece& piece : engine.new_data(cause.ref, reg))
            append(pieces, own, piece.l, piece.r);
        break;
    case Cause::Kind::both:
    case Cause::Kind::either:
        pieces = of(cause.a, reg);
        pieces.insert(pieces.end(), of(cause.b, reg).begin(), of(cause.b, reg).end());
        break;
    case Cause::Kind::least:
    case Cause::Kind::greatest:
        widen(pieces, of(cause.a, reg), cause.low, cause.high);
        break;
    case Cause::Kind::until:
    case Cause::Kind::since:
        pieces = reg == 0 ? together(engine, cause, last) : apart(cause);
    }
    clip(pieces, last);
    envelope(pieces);
    const bool predicate = cause.kind == Cause::Kind::atom || cause.kind == Cause::Kind::span;
    const bool recursion = cause.kind == Cause::Kind::until || cause.kind == Cause::Kind::since;
    if (predicate) return;
    if (recursion ? reg == 1 : !takes_greatest(cause.kind, reg)) limit(pieces, own);
}

// Where one part is as good as it is because of what is new, and all others are as good as their
// bounds.
Pieces Causes::together(const BoundsEngine& engine, const Cause& cause, Tick last) const {
    using Recursion = CausedUntil::Kind;
    const bool back = cause.kind == Cause::Kind::since;
    const std::uint32_t hold = causes_[cause.a / 2].ref ^ (cause.a & 1U);
    const std::uint32_t goal = causes_[cause.b / 2].ref ^ (cause.b & 1U);
    const CausedUntil until{.kind = !dense_ ? Recursion::discrete
                                    : back  ? Recursion::dense_since
                                            : Recursion::dense,
                            .hold = View(engine.runs(hold, 0), back),
                            .goal = View(engine.runs(goal, 0), back),
                            .core = View(engine.runs(cause.core, 0), back),
                            .own = View(engine.runs(cause.ref, 0), back),
                            .low = cause.low,
                            .high = cause.high,
                            .first = back ? -last : -cause.shift,
                            .last = back ? 0 : last,
                            .shift = cause.shift};
    if (back) return reversed(until(reversed(of(cause.a, 0)), reversed(of(cause.b, 0))));
    return shifted(until(of(cause.a, 0), of(cause.b, 0)), cause.shift);
}

// Where any part is required.
Pieces Causes::apart(const Cause& cause) const {
    Pieces pieces;
    const Tick rest = dense_ ? 0 : 1; // of a goal's tick: hold is required in a part of it
    if (cause.kind == Cause::Kind::since) {
        // There is a goal from low on, and in discrete time hold comes after it.
        for (const Run& run : of(cause.a, 1)) {
            const Tick from = std::max(run.begin, rest);
            const Tick begin = std::max(from, cause.low);
            const Tick end = plus(run.end, plus(cause.high, -rest));
            if (cause.high > 0 && from <= run.end && begin <= end) {
                pieces.push_back({begin, end, run.value});
            }
        }
        widen(pieces, of(cause.b, 1), -cause.high, -cause.low);
    } else {
        const Tick low = -cause.shift;
        if (cause.high > 0) widen(pieces, of(cause.a, 1), low, plus(cause.high, low - rest));
        widen(pieces, of(cause.b, 1), cause.low + low, plus(cause.high, low));
    }
    return pieces;
}

// ---- the start of the trace ---------------------------------------------------------------------

double Causes::item(const BoundsEngine& engine, const BoundsAtStart& at_start, std::size_t index,
                    int reg) const noexcept {
    const Item& item = at_start.item(index);
    const StartingCause& start = starts_[index];
    const double own = at_start.value(index, reg);
    if (start.rest != none || item.kind == Item::Kind::until) {
        if (start.b == none) return -infinity; // a part of the item of both
        if (reg == 0) return until_item(engine, at_start, index);
        const Tick from = at_start.item(start.rest == none ? index : start.rest).tick;
        return Real::meet(own, Real::join(most(of(start.b, 1), from), most(of(start.a, 1), 0)));
    }
    const auto r = static_cast<std::size_t>(reg);
    switch (item.kind) {
    case Item::Kind::value:
        return start.a == none ? -infinity : value_at(of(start.a, reg), item.tick);
    case Item::Kind::all:
    case Item::Kind::some: {
        const double caused = most(of(start.a, reg), item.tick);
        return (item.kind == Item::Kind::some) == (reg == 0) ? caused : Real::meet(caused, own);
    }
    default: {
        const double caused = Real::join(items_[item.a][r], items_[item.b][r]);
        return (item.kind == Item::Kind::either) == (reg == 0) ? caused : Real::meet(caused, own);
    }
    }
}

double Causes::until_item(const BoundsEngine& engine, const BoundsAtStart& at_start,
                          std::size_t index) const noexcept {
    const StartingCause& start = starts_[index];
    const std::size_t recursion = start.rest == none ? index : start.rest;
    const Item& item = at_start.item(recursion);
    const double before = start.before == none ? infinity : at_start.value(start.before, 0);
    const Tick next = at_start.next(recursion);
    const auto held = [&](Tick end) { // over [0, end)
        double value = Real::meet(before, at_start.held(recursion, 0));
        if (end > next) value = Real::meet(value, engine.runs(item.b, 0).least(next, end - 1));
        return value;
    };
    double result = -infinity;
    for (const Run& run : of(start.b, 0)) {
        if (run.end < item.tick) continue;
        result = Real::join(result, Real::meet(run.value, held(std::max(run.begin, item.tick))));
    }
    for (const Run& run : of(start.a, 0)) {
        // In dense time hold may be required in a part of the tick of the goal.
        const Tick goal = std::max(dense_ ? run.begin : run.begin + 1, item.tick);
        const double rest = engine.runs(item.a, 0).at(goal).value;
        result = Real::join(result, std::min({run.value, held(dense_ ? goal + 1 : goal), rest}));
    }
    return result;
}

// ---- results ------------------------------------------------------------------------------------

Bounds Causes::at(std::size_t output, Tick t) const noexcept {
    return {value_at(known_[output][0], t), -value_at(known_[output][1], t)};
}

std::vector<BoundChange> Causes::runs(std::size_t output, Tick last) const {
    return caused_runs(known_[output][0], known_[output][1], last);
}

std::vector<BoundChange> caused_runs(const Pieces& satisfaction, const Pieces& violation,
                                     Tick last) {
    std::vector<Tick> borders;
    for (const Pieces& pieces : {std::cref(satisfaction), std::cref(violation)}) {
        for (const Run& run : pieces) {
            borders.push_back(run.begin);
            borders.push_back(plus(run.end, 1));
        }
    }
    std::ranges::sort(borders);
    const auto twice = std::ranges::unique(borders);
    borders.erase(twice.begin(), twice.end());
    std::vector<BoundChange> result;
    for (std::size_t i = 0; i + 1 < borders.size() && borders[i] <= last; ++i) {
        const Bounds bounds{value_at(satisfaction, borders[i]), -value_at(violation, borders[i])};
        if (bounds == bounds::anything) continue;
        const Tick end = borders[i + 1] < forever ? borders[i + 1] - 1 : forever;
        result.push_back({borders[i], std::min(last, end), bounds});
    }
    return result;
}

void Causes::transfer(Snapshot& snapshot) {
    for (Part& part : known_) {
        for (Pieces& pieces : part) {
            Tick end = 0;
            checked::list(snapshot, pieces, sizeof(Run), [&](Run& piece) {
                checked::run(snapshot, piece.begin, piece.end, end);
                checked::number(snapshot, piece.value);
            });
        }
    }
    checked::numbers(snapshot, start_);
}

} // namespace rtamt::early
