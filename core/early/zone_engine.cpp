#include "zone_engine.hpp"

#include "state_checks.hpp"

#include <algorithm>
#include <ranges>
#include <type_traits>
#include <utility>

namespace rtamt::early {

// ---- choice -----------------------------------------------------------------------------------

std::optional<ZoneEngine> ZoneEngine::of(const Graph& graph, std::span<const std::uint32_t> outputs,
                                         std::span<const Item> start,
                                         std::span<const Bounds> ranges, Tick factor) {
    const bool known_start =
        start.empty() ||
        (start.size() == 1 && start[0].kind == Item::Kind::value && start[0].tick == 0);
    if (!known_start) return std::nullopt;
    ZoneEngine zone(graph, outputs, start, ranges);
    if (!zone.fits(factor)) return std::nullopt;
    zone.compute();
    return zone;
}

ZoneEngine::ZoneEngine(const Graph& graph, std::span<const std::uint32_t> outputs,
                       std::span<const Item> start, std::span<const Bounds> ranges)
    : graph_(graph), outputs_(outputs.begin(), outputs.end()),
      ranges_(ranges.begin(), ranges.end()), reach_(graph.nodes.size()),
      columns_(graph.nodes.size()), final_(outputs.size()), results_(graph.nodes.size()) {
    if (!start.empty()) start_ = start[0];
    ranges_.resize(graph.inputs, bounds::anything);
    std::size_t steps = 0;
    for (const Node& node : graph_.nodes)
        steps = std::max(steps, node.steps.size());
    exact_.resize(steps);
    bounds_.resize(steps);
}

// How many ticks are computed in the time in which BoundsEngine follows what a sample of noise
// changes of a node (benchmarks/zone_bench.cpp, benchmarks/early.py).
Tick ZoneEngine::ticks_to_follow(const Node& node) const noexcept {
    switch (node.kind) {
    case Kind::atom:
        return 14;
    case Kind::least:
    case Kind::greatest: // a window over an atom slides
        return !is_unbounded(node) && graph_.nodes[node.a / 2].kind == Kind::atom ? 25 : 120;
    case Kind::until:
        return 220;
    case Kind::since:
        return 85;
    default:
        return 110;
    }
}

// Whether columns are short enough, and every node is one of which they can be computed.
bool ZoneEngine::fits(Tick factor) {
    constexpr Tick row = 30; // what a row costs whatever the columns, in ticks
    Tick limit = 0;
    for (const Node& node : graph_.nodes)
        limit += factor * ticks_to_follow(node);
    Tick total = row; // ticks that are computed
    for (std::size_t i = 0; i < columns_.size(); ++i) {
        const Node& node = graph_.nodes[i];
        Reach& own = reach_[i];
        for (const std::uint32_t ref : {node.a, node.b}) {
            if (node.kind != Kind::atom && ref != none)
                own.ahead = std::max(own.ahead, reach_[ref / 2].ahead);
        }
        switch (node.kind) {
        case Kind::atom: {
            const Wrong wrong = enclose(node.steps, ranges_, bounds_);
            if (wrong.any != none) return false; // future samples have no value
            const Bounds& unseen = bounds_[node.steps.size() - 1];
            columns_[i].rest = {unseen.lower, -unseen.upper};
            break;
        }
        case Kind::least:
        case Kind::greatest:
            if (node.high > limit || (!is_unbounded(node) && node.low < -limit)) return false;
            if (!is_unbounded(node)) total += node.high - node.low;
            own.ahead = std::max<Tick>(0, own.ahead - (is_unbounded(node) ? node.high : node.low));
            break;
        case Kind::both:
        case Kind::either:
        case Kind::until:
        case Kind::since:
            break;
        default:
            return false;
        }
        if (is_recursive(node)) {
            recursive_ = true;
            own.behind = node.horizon; // earlier values are final
        }
    }
    const auto keep_until_final = [this](std::uint32_t ref) {
        Reach& reach = reach_[ref / 2];
        reach.behind = std::max(reach.behind, graph_.nodes[ref / 2].horizon);
    };
    for (const std::uint32_t output : outputs_)
        keep_until_final(output);
    if (start_) keep_until_final(start_->a); // which may be no output
    for (std::size_t i = columns_.size(); i-- > 0;) {
        const Node& node = graph_.nodes[i];
        const Reach& own = reach_[i];
        if (own.behind > limit) return false;
        total += own.behind + own.ahead + 1;
        if (node.kind == Kind::atom) continue;
        const Tick first = is_unbounded(node) ? node.high : node.low;
        for (const std::uint32_t ref : {node.a, node.b}) {
            if (ref == none) continue;
            Reach& reach = reach_[ref / 2];
            reach.behind = std::max(reach.behind, own.behind - first);
        }
    }
    return total <= limit;
}

// ---- samples
// -------------------------------------------------------------------------------------

template <class Value>
std::optional<BoundsEngine::Failure> ZoneEngine::row(Tick t, std::span<const Value> values) {
    for (std::uint32_t i = 0; i < columns_.size(); ++i) {
        const auto& steps = graph_.nodes[i].steps;
        if (graph_.nodes[i].kind != Kind::atom) continue;
        if constexpr (std::is_same_v<Value, double>) {
            const std::uint32_t wrong = run<double>(steps, values, exact_);
            if (wrong != none) return BoundsEngine::Failure{i, wrong, t};
            results_[i] = Interval::of(exact_[steps.size() - 1]);
        } else {
            const std::uint32_t wrong = run<Bounds>(steps, values, bounds_);
            if (wrong != none) return BoundsEngine::Failure{i, wrong, t};
            results_[i] = bounds_[steps.size() - 1];
        }
    }
    newest_before_ = newest_;
    before_.resize(outputs_.size());
    for (std::size_t k = 0; k < outputs_.size(); ++k)
        before_[k] = columns_[outputs_[k] / 2];
    skip(t);
    append(results_);
    compute();
    for (std::size_t k = 0; k < outputs_.size(); ++k)
        add_runs(final_[k], before_[k], outputs_[k], before_[k].first,
                 columns_[outputs_[k] / 2].first - 1);
    return std::nullopt;
}

template std::optional<BoundsEngine::Failure> ZoneEngine::row(Tick, std::span<const double>);
template std::optional<BoundsEngine::Failure> ZoneEngine::row(Tick, std::span<const Bounds>);

// A sample of all atoms; other nodes are left to be computed.
void ZoneEngine::append(std::span<const Bounds> results) {
    ++newest_;
    for (std::size_t i = 0; i < columns_.size(); ++i) {
        if (graph_.nodes[i].kind != Kind::atom) continue;
        Column& own = columns_[i];
        const bool full = newest_ - own.first > reach_[i].behind;
        for (std::size_t reg = 0; reg < 2; ++reg) {
            const double value = reg == 0 ? results[i].lower : -results[i].upper;
            auto& known = own.values[reg];
            if (full) {
                std::ranges::copy(std::span(known).subspan(1), known.begin());
                known.back() = value;
            } else {
                known.push_back(value);
            }
        }
        own.first += full ? 1 : 0;
    }
}

// Missing samples before a tick. After so many of them that all columns hold nothing else,
// more of them only move columns on.
void ZoneEngine::skip(Tick t) {
    std::vector<Bounds> unseen;
    Tick settled = 1;
    for (std::size_t i = 0; newest_ + 1 < t && i < columns_.size(); ++i) {
        unseen.push_back({columns_[i].rest[0], -columns_[i].rest[1]});
        settled += reach_[i].behind + reach_[i].ahead + 1;
    }
    for (; newest_ + 1 < t && settled > 0; --settled) {
        append(unseen);
        if (recursive_) compute();
    }
    if (newest_ + 1 >= t) return;
    for (Column& column : columns_)
        column.first += t - 1 - newest_;
    newest_ = t - 1;
}

// ---- results
// -------------------------------------------------------------------------------------

Bounds ZoneEngine::bounds_of(const Column& column, std::uint32_t ref, Tick t) noexcept {
    const int flipped = static_cast<int>(ref & 1U);
    return {column.at(flipped, t), -column.at(1 - flipped, t)};
}

Bounds ZoneEngine::at(std::size_t output, Tick t) const noexcept {
    return bounds_of(columns_[outputs_[output] / 2], outputs_[output], t);
}

// Adds the bounds at [l, r] to runs that end just before, or somewhere before.
void ZoneEngine::add_runs(std::vector<BoundChange>& runs, const Column& column, std::uint32_t ref,
                          Tick l, Tick r) {
    while (l <= r) {
        const Tick last = l < column.end() ? l : r;
        const Bounds bounds = bounds_of(column, ref, l);
        if (!runs.empty() && runs.back().r == l - 1 && runs.back().bounds == bounds) {
            runs.back().r = last;
        } else {
            runs.push_back({l, last, bounds});
        }
        l = last + 1;
    }
}

std::vector<Bounds> ZoneEngine::all_from(std::size_t output, Tick first) const {
    std::vector<Bounds> result;
    for (const auto& [l, r, bounds] : final_[output]) {
        for (Tick t = std::max(l, first); t <= r; ++t)
            result.push_back(bounds);
    }
    for (Tick t = std::max(columns_[outputs_[output] / 2].first, first); t <= newest_; ++t)
        result.push_back(at(output, t));
    return result;
}

void ZoneEngine::drop_before(std::size_t output, Tick t) {
    std::erase_if(final_[output], [t](const BoundChange& run) { return run.r < t; });
}

Tick ZoneEngine::first_change(std::size_t output) const {
    const auto found = changes(output);
    return found.empty() ? forever : found.front().l;
}

std::vector<BoundChange> ZoneEngine::changes(std::size_t output) const {
    std::vector<BoundChange> result;
    if (before_.empty()) return result;
    const std::uint32_t ref = outputs_[output];
    const Column& now = columns_[ref / 2];
    const Column& before = before_[output];
    for (Tick t = now.first; t <= newest_before_; ++t) {
        if (bounds_of(now, ref, t) != bounds_of(before, ref, t)) add_runs(result, now, ref, t, t);
    }
    // What has left the column is behind ticks without a sample, which the sample did not change.
    add_runs(result, before, ref, newest_before_ + 1, now.first - 1);
    add_runs(result, now, ref, std::max(newest_before_ + 1, now.first), newest_);
    return result;
}

ZoneEngine ZoneEngine::supposed(std::span<const BoundsEngine::Supposition> suppositions) const {
    ZoneEngine zone = *this;
    const auto rests = [&](std::size_t i) {
        return Bounds{columns_[i].rest[0], -columns_[i].rest[1]};
    };
    const auto suppose = [&](const std::vector<Bounds>& row) {
        for (std::size_t i = 0; i < columns_.size(); ++i) {
            if (graph_.nodes[i].kind != Kind::atom) continue;
            zone.results_[i] = rests(i);
            const auto& steps = graph_.nodes[i].steps;
            if (early::run<Bounds>(steps, row, zone.bounds_) != none) continue; // it is not known
            const Bounds& found = zone.bounds_[steps.size() - 1];
            zone.results_[i] = {Real::join(rests(i).lower, found.lower),
                                Real::meet(rests(i).upper, found.upper)};
        }
    };
    for (const auto& [l, r, row] : suppositions) {
        suppose(row);
        if (r >= forever) {
            for (std::size_t i = 0; i < columns_.size(); ++i) {
                if (graph_.nodes[i].kind == Kind::atom)
                    zone.columns_[i].rest = {zone.results_[i].lower, -zone.results_[i].upper};
            }
            continue;
        }
        for (Tick t = l; t <= r; ++t) {
            for (Reach& reach : zone.reach_)
                ++reach.behind; // nothing is given up
            zone.append(zone.results_);
        }
    }
    zone.compute();
    return zone;
}

ZoneEngine ZoneEngine::ended() const {
    ZoneEngine zone = *this;
    zone.ended_ = true;
    zone.compute();
    return zone;
}

// ---- state
// ---------------------------------------------------------------------------------------

std::size_t ZoneEngine::bytes() const noexcept {
    std::size_t sum = 0;
    for (const Column& column : columns_)
        sum += (column.values[0].capacity() + column.values[1].capacity()) * sizeof(double);
    return 2 * sum; // with what was before
}

void ZoneEngine::transfer(Snapshot& snapshot) {
    const auto number = [&](double& value) { checked::number(snapshot, value); };
    checked::tick(snapshot, newest_, -1);
    checked::numbers(snapshot, at_start_);
    for (auto& runs : final_) {
        Tick end = 0;
        checked::list(snapshot, runs, sizeof(BoundChange), [&](BoundChange& run) {
            checked::run(snapshot, run.l, run.r, end);
            checked::numbers(snapshot, run.bounds);
        });
        snapshot.require(end <= std::max<Tick>(0, newest_));
    }
    for (std::size_t i = 0; i < columns_.size(); ++i) {
        const Node& node = graph_.nodes[i];
        Column& own = columns_[i];
        if (snapshot.loading()) own.first = std::max<Tick>(0, newest_ - reach_[i].behind);
        if (is_recursive(node)) {
            number(own.before[0]);
            number(own.before[1]);
        }
        if (node.kind != Kind::atom) continue;
        for (auto& values : own.values) {
            values.resize(static_cast<std::size_t>(newest_ - own.first + 1));
            for (double& value : values)
                number(value);
        }
    }
    checked::tick(snapshot, newest_before_, -1);
    snapshot.require(newest_before_ <= newest_);
    bool has_row = !before_.empty();
    snapshot.item(has_row);
    before_.resize(has_row ? outputs_.size() : 0);
    for (Column& before : before_) {
        checked::tick(snapshot, before.first);
        std::size_t size = before.values[0].size();
        snapshot.count(size, 2 * sizeof(double));
        for (auto& values : before.values) {
            values.resize(size);
            for (double& value : values)
                number(value);
        }
        for (double& value : before.rest)
            number(value);
    }
    if (snapshot.loading()) compute();
}

} // namespace rtamt::early
