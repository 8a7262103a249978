#include "causation.hpp"

#include "../program/snapshot.hpp"

#include <algorithm>
#include <ranges>
#include <stdexcept>
#include <utility>

namespace rtamt::early {

namespace {

using Pieces = std::vector<Run>;

void append(Pieces& pieces, Tick begin, Tick end, double value) {
    if (begin > end || value == -infinity) return;
    if (!pieces.empty() && pieces.back().end == begin - 1 && pieces.back().value == value) {
        pieces.back().end = end;
    } else {
        pieces.push_back({begin, end, value});
    }
}

// The values of a register at the ticks of [l, r].
void append(Pieces& pieces, const Runs& own, Tick l, Tick r) {
    while (l <= r) {
        const Run run = own.at(l);
        const Tick end = std::min(run.end, r);
        append(pieces, l, end, run.value);
        l = end + 1;
    }
}

// Makes of runs that overlap their maximum, in order of time.
void envelope(Pieces& pieces) {
    if (pieces.size() < 2) return;
    std::ranges::sort(pieces, {}, &Run::begin);
    Pieces heap; // of those that have begun, the greatest first
    const auto less = [](const Run& a, const Run& b) { return a.value < b.value; };
    Pieces result;
    Tick t = 0;
    for (std::size_t next = 0; next < pieces.size() || !heap.empty();) {
        if (heap.empty()) t = std::max(t, pieces[next].begin);
        for (; next < pieces.size() && pieces[next].begin <= t; ++next) {
            heap.push_back(pieces[next]);
            std::ranges::push_heap(heap, less);
        }
        const Run greatest = heap.front();
        if (greatest.end < t) {
            std::ranges::pop_heap(heap, less);
            heap.pop_back();
            continue;
        }
        Tick end = greatest.end;
        if (next < pieces.size()) end = std::min(end, pieces[next].begin - 1);
        append(result, t, end, greatest.value);
        t = end + 1;
    }
    pieces = std::move(result);
}

// Cuts runs to [0, last].
void clip(Pieces& pieces, Tick last) {
    std::erase_if(pieces, [&](const Run& run) { return run.end < 0 || run.begin > last; });
    for (Run& run : pieces)
        run = {std::max<Tick>(0, run.begin), std::min(last, run.end), run.value};
}

// Cuts what is caused to the bound of the part itself.
void limit(Pieces& pieces, const Runs& own) {
    Pieces result;
    for (const Run& piece : pieces) {
        for (Tick t = piece.begin; t <= piece.end;) {
            const Run bound = own.at(t);
            const Tick end = std::min(piece.end, bound.end);
            append(result, t, end, Real::meet(piece.value, bound.value));
            t = end + 1;
        }
    }
    pieces = std::move(result);
}

// A window [t + low, t + high] sees a run at the ticks from begin - high to end - low.
void widen(Pieces& pieces, const Pieces& operand, Tick low, Tick high) {
    if (low > high) return;
    for (const Run& run : operand)
        pieces.push_back({plus(run.begin, -high), plus(run.end, -low), run.value});
}

// The register of a node, perhaps in reversed time: since is until there.
class View {
  public:
    View(const Runs& runs, bool reversed) : runs_(runs), reversed_(reversed) {}

    [[nodiscard]] double at(Tick t) const noexcept { return runs_.at(reversed_ ? -t : t).value; }
    [[nodiscard]] double least(Tick l, Tick r) const noexcept {
        turn(l, r);
        return l > r ? infinity : runs_.least(l, r);
    }
    [[nodiscard]] double most(Tick l, Tick r) const noexcept {
        turn(l, r);
        return l > r ? -infinity : runs_.most(l, r);
    }
    // The last tick in [l, r] with a lesser value, l - 1 if there is none.
    [[nodiscard]] Tick last_below(Tick l, Tick r, double value) const noexcept {
        const Tick none_there = l - 1;
        turn(l, r);
        if (reversed_) {
            const auto found = runs_.first<Below>(l, r, value);
            return found ? -found->begin : none_there;
        }
        const auto found = runs_.last<Below>(l, r, value);
        return found ? found->end : none_there;
    }

  private:
    const Runs& runs_;
    bool reversed_;

    void turn(Tick& l, Tick& r) const noexcept {
        if (reversed_) l = -std::exchange(r, -l);
        l = std::max<Tick>(0, l); // before the start there is nothing
    }
};

// What the operands of until, goal within [t + low, t + high] and hold in [t, goal), cause where
// both are as good as their lower bounds; `first` and `last`: the ticks that are asked for.
struct Until {
    View hold;
    View goal;
    View core; // the recursion without bounds
    Tick low = 0;
    Tick high = 0;
    Tick first = 0;
    Tick last = 0;

    // The newest sample is in the goal of [l, r].
    void by_goal(Pieces& pieces, const Run& run) const {
        const auto [l, r, value] = run;
        const Tick near = plus(l, -low); // up to here the first goal is that at l
        const Tick from = std::max(first, plus(l, -high));
        if (low == 0) {
            append(pieces, std::max(l, first), std::min(r, last), value);
        } else {
            for (Tick t = std::max(near + 1, first); t <= std::min(r - low, last); ++t)
                pieces.push_back({t, t, Real::meet(value, hold.least(t, t + low - 1))});
        }
        Tick t = low == 0 ? l - 1 : near;
        if (t > last) t = last;
        while (t >= from) {
            const double now = Real::meet(value, hold.least(t, l - 1));
            if (now == -infinity) return;
            const Tick stop = std::max(hold.last_below(from, t, now), from - 1);
            pieces.push_back({stop + 1, t, now});
            t = stop;
        }
    }

    // The newest sample is in the hold of [l, r], and a goal comes later.
    void by_hold(Pieces& pieces, const Run& run) const {
        const auto [l, r, value] = run;
        const Tick near = std::min(l, l + 1 - low);
        for (Tick t = std::min(r, last); t >= std::max(first, plus(l + 1, -high)); --t) {
            const Tick goal_from = std::max(std::max(l, t) + 1, t + low);
            const Tick goal_to = plus(t, high);
            if (goal_from > goal_to) continue;
            const double now = std::min({value, core.at(goal_from), hold.least(t, goal_from - 1),
                                         goal.most(goal_from, goal_to)});
            if (now > -infinity) {
                pieces.push_back({t, t, now});
            } else if (t <= near) {
                return; // for earlier ticks it is no more
            }
        }
    }
};

[[nodiscard]] Pieces reversed(const Pieces& pieces) {
    Pieces result;
    result.reserve(pieces.size());
    for (const Run& run : std::views::reverse(pieces))
        result.push_back({-run.end, -run.begin, run.value});
    return result;
}

[[nodiscard]] bool takes_greatest(Cause::Kind kind, int reg) noexcept {
    return (kind == Cause::Kind::either || kind == Cause::Kind::greatest) == (reg == 0);
}

} // namespace

Causes::Causes(std::vector<Cause> parts, std::vector<std::uint32_t> outputs,
               std::vector<StartingCause> starts, const Engine& engine, const Origin& origin)
    : causes_(std::move(parts)), outputs_(std::move(outputs)), starts_(std::move(starts)),
      parts_(causes_.size()), known_(outputs_.size()), items_(starts_.size()) {
    const auto require = [](bool holds) {
        if (!holds) throw std::invalid_argument("This is no causation that an engine can compute.");
    };
    const auto earlier = [&](std::uint32_t ref, std::size_t end) { return ref / 2 < end; };
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
        for (const Tick bound : {cause.low, cause.high}) {
            if (bound > -forever && bound < forever) reach_ += bound < 0 ? -bound : bound;
        }
        reach_ = std::min(reach_ + cause.shift + 2, forever / 4);
    }
    for (const std::uint32_t output : outputs_)
        require(earlier(output, causes_.size()));
    require(starts_.size() == origin.size());
    for (std::size_t i = 0; i < starts_.size(); ++i) {
        const StartingCause& start = starts_[i];
        const Item::Kind kind = origin.item(i).kind;
        for (const std::uint32_t ref : {start.a, start.b})
            require(ref == none || earlier(ref, causes_.size()));
        require((start.b == none || start.a != none) && (start.before < i || start.rest == none));
        require(start.rest == none || (start.rest < i && start.b != none &&
                                       origin.item(start.rest).kind == Item::Kind::until));
        require(start.a != none || (kind != Item::Kind::all && kind != Item::Kind::some));
    }
}

void Causes::look(const Engine& engine, const Origin& origin, Tick newest) {
    for (std::size_t i = 0; i < causes_.size(); ++i) {
        for (int reg = 0; reg < 2; ++reg)
            compute(engine, i, reg, newest);
    }
    for (std::size_t i = 0; i < outputs_.size(); ++i)
        known_[i] = {of(outputs_[i], 0), of(outputs_[i], 1)};
    for (std::size_t i = 0; i < starts_.size(); ++i) {
        items_[i] = {item(engine, origin, i, 0), item(engine, origin, i, 1)};
        if (origin.item(i).negated) std::swap(items_[i][0], items_[i][1]);
    }
    if (!items_.empty()) start_ = {items_.back()[0], -items_.back()[1]};
}

void Causes::compute(const Engine& engine, std::size_t index, int reg, Tick newest) {
    const Cause& cause = causes_[index];
    Pieces& pieces = parts_[index][static_cast<std::size_t>(reg)];
    const Runs& own = engine.runs(cause.ref, reg);
    const Tick last = newest + 2 * reach_;
    pieces.clear();
    switch (cause.kind) {
    case Cause::Kind::atom:
        append(pieces, newest, newest, own.at(newest).value);
        return;
    case Cause::Kind::span:
        for (const Piece& piece : engine.news(cause.ref, reg))
            append(pieces, own, piece.l, piece.r);
        clip(pieces, last);
        envelope(pieces);
        return;
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
    case Cause::Kind::since: {
        const bool back = cause.kind == Cause::Kind::since;
        if (reg == 1) {
            if (back) {
                // Hold comes after a goal, so not at the start; there is a goal from low on.
                for (const Run& run : of(cause.a, reg)) {
                    const Tick begin = std::max({run.begin, cause.low, Tick{1}});
                    const Tick end = plus(run.end, cause.high - 1);
                    if (run.end > 0 && cause.high > 0 && begin <= end) {
                        pieces.push_back({begin, end, run.value});
                    }
                }
                widen(pieces, of(cause.b, reg), -cause.high, -cause.low);
            } else {
                const Tick low = -cause.shift;
                widen(pieces, of(cause.a, reg), low, plus(cause.high, low - 1));
                widen(pieces, of(cause.b, reg), cause.low + low, plus(cause.high, low));
            }
            break;
        }
        const std::uint32_t hold = causes_[cause.a / 2].ref ^ (cause.a & 1U);
        const std::uint32_t goal = causes_[cause.b / 2].ref ^ (cause.b & 1U);
        const Until until{View(engine.runs(hold, 0), back),
                          View(engine.runs(goal, 0), back),
                          View(engine.runs(cause.core, 0), back),
                          cause.low,
                          cause.high,
                          back ? -last : -cause.shift,
                          back ? 0 : last};
        for (const Run& run : back ? reversed(of(cause.b, 0)) : of(cause.b, 0))
            until.by_goal(pieces, run);
        for (const Run& run : back ? reversed(of(cause.a, 0)) : of(cause.a, 0))
            until.by_hold(pieces, run);
        if (back) pieces = reversed(pieces);
        for (Run& run : pieces)
            run = {run.begin + cause.shift, run.end + cause.shift, run.value};
    }
    }
    clip(pieces, last);
    envelope(pieces);
    const bool recursion = cause.kind == Cause::Kind::until || cause.kind == Cause::Kind::since;
    if (recursion ? reg == 1 : !takes_greatest(cause.kind, reg)) limit(pieces, own);
}

// ---- the start of the trace ---------------------------------------------------------------------

namespace {

[[nodiscard]] double most(const Pieces& pieces, Tick from) noexcept {
    double result = -infinity;
    for (const Run& run : pieces) {
        if (run.end >= from) result = Real::join(result, run.value);
    }
    return result;
}

[[nodiscard]] double value_at(const Pieces& pieces, Tick t) noexcept {
    for (const Run& run : pieces) {
        if (run.begin <= t && t <= run.end) return run.value;
    }
    return -infinity;
}

} // namespace

double Causes::item(const Engine& engine, const Origin& origin, std::size_t index,
                    int reg) const noexcept {
    const Item& item = origin.item(index);
    const StartingCause& start = starts_[index];
    const double own = origin.value(index, reg);
    if (start.rest != none || item.kind == Item::Kind::until) {
        if (start.b == none) return -infinity; // a part of the item of both
        if (reg == 0) return until_item(engine, origin, index);
        const Tick from = origin.item(start.rest == none ? index : start.rest).tick;
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

double Causes::until_item(const Engine& engine, const Origin& origin,
                          std::size_t index) const noexcept {
    const StartingCause& start = starts_[index];
    const std::size_t recursion = start.rest == none ? index : start.rest;
    const Item& item = origin.item(recursion);
    const double before = start.before == none ? infinity : origin.value(start.before, 0);
    const Tick next = origin.next(recursion);
    const auto held = [&](Tick end) { // over [0, end)
        double value = Real::meet(before, origin.held(recursion, 0));
        if (end > next) value = Real::meet(value, engine.runs(item.b, 0).least(next, end - 1));
        return value;
    };
    double result = -infinity;
    for (const Run& run : of(start.b, 0)) {
        if (run.end < item.tick) continue;
        result = Real::join(result, Real::meet(run.value, held(std::max(run.begin, item.tick))));
    }
    for (const Run& run : of(start.a, 0)) {
        const Tick goal = std::max(run.begin + 1, item.tick);
        const double rest = engine.runs(item.a, 0).at(goal).value;
        result = Real::join(result, std::min({run.value, held(goal), rest}));
    }
    return result;
}

// ---- answers ------------------------------------------------------------------------------------

Bounds Causes::at(std::size_t output, Tick t) const noexcept {
    return {value_at(known_[output][0], t), -value_at(known_[output][1], t)};
}

void Causes::transfer(Snapshot& snapshot) {
    for (Part& part : known_) {
        for (Pieces& pieces : part) {
            std::size_t size = pieces.size();
            snapshot.count(size, sizeof(Run));
            pieces.resize(size);
            snapshot.values(pieces.data(), size);
        }
    }
    snapshot.item(start_);
}

} // namespace rtamt::early
