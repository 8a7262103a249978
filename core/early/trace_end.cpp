#include "trace_end.hpp"

#include "sliding.hpp"

#include <algorithm>
#include <cstddef>
#include <stdexcept>

namespace rtamt::early {

namespace {

[[nodiscard]] Bounds join(const Bounds& a, const Bounds& b, bool greatest) noexcept {
    return greatest ? Interval::join(a, b) : Interval::meet(a, b);
}

// Values from a tick on. Others are read after a forged state alone, which is an error then.
struct Column {
    Tick first = 0;
    std::vector<Bounds> values;

    [[nodiscard]] Bounds& at(Tick t) {
        const auto place = static_cast<std::size_t>(t - first);
        if (place >= values.size()) {
            throw std::invalid_argument("This is not the state of a monitor of this program: it "
                                        "has no values where the end of the trace reads some.");
        }
        return values[place];
    }
    [[nodiscard]] Bounds at(Tick t, bool flipped) {
        const Bounds& value = at(t);
        return flipped ? Interval::neg(value) : value;
    }
};

// The value of this rank, counted from the greatest or the least; an infinity where there are
// fewer.
[[nodiscard]] double ranked(std::vector<double>& values, std::size_t order, bool greatest) {
    if (order > values.size()) return greatest ? -infinity : infinity;
    const std::size_t place = greatest ? values.size() - order : order - 1;
    const auto wanted = values.begin() + static_cast<std::ptrdiff_t>(place);
    std::ranges::nth_element(values, wanted);
    return *wanted;
}

} // namespace

std::vector<BoundsEngine::Rest> bounds_at_end(const Graph& graph, std::span<const HeldNode> held,
                                              const std::function<Bounds(std::uint32_t, Tick)>& at,
                                              std::span<const std::uint32_t> refs, Tick end,
                                              std::optional<BoundsEngine::Failure>* failure) {
    std::vector<Column> columns(graph.nodes.size());
    const auto wrong = [&](std::size_t index, std::uint32_t step, Tick t) {
        if (failure != nullptr && !*failure && t < end)
            *failure = BoundsEngine::Failure{static_cast<std::uint32_t>(index), step, t};
    };
    for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
        const Node& own = graph.nodes[i];
        const HeldNode& state = held[i];
        Column& column = columns[i];
        column.first = std::clamp<Tick>(state.keep, 0, end);
        column.values.resize(static_cast<std::size_t>(end - column.first));
        const auto place = [&](Tick t) -> Bounds& { return column.at(t); };
        for (Tick t = column.first; t < end; ++t)
            place(t) = at(static_cast<std::uint32_t>(2 * i), t);
        const Tick from = std::max(state.from, column.first);
        if (own.kind == Kind::atom) wrong(i, state.step, state.undefined);
        if (own.kind == Kind::atom || from >= end) continue;
        const auto a = [&](Tick t) { return columns[own.a / 2].at(t, (own.a & 1U) != 0); };
        const auto b = [&](Tick t) { return columns[own.b / 2].at(t, (own.b & 1U) != 0); };
        switch (own.kind) {
        case Kind::map:
            for (Tick t = from; t < end; ++t) {
                const Bounds first = a(t);
                place(t) = compute(own.steps.front().opcode, first, own.b == none ? first : b(t));
                if (!Interval::undefined(place(t))) continue;
                wrong(i, 0, t);
                place(t) = bounds::anything;
            }
            break;
        case Kind::both:
        case Kind::either:
            for (Tick t = from; t < end; ++t)
                place(t) = join(a(t), b(t), own.kind == Kind::either);
            break;
        case Kind::held:
            for (Tick t = from; t < end; ++t)
                place(t) = a(std::clamp<Tick>(plus(t, own.low), 0, end - 1));
            break;
        case Kind::rank_least:
        case Kind::rank_greatest: {
            const bool greatest = own.kind == Kind::rank_greatest;
            for (Tick t = from; t < end; ++t) {
                std::vector<double> lower;
                std::vector<double> upper;
                const Tick last = std::min(end - 1, plus(t, own.high));
                for (Tick u = std::max<Tick>(0, plus(t, own.low)); u <= last; ++u) {
                    lower.push_back(a(u).lower);
                    upper.push_back(a(u).upper);
                }
                const auto order = static_cast<std::size_t>(own.steps.front().x);
                place(t) = {ranked(lower, order, greatest), ranked(upper, order, greatest)};
            }
            break;
        }
        case Kind::until: {
            Bounds next = Interval::bottom;
            for (Tick t = end; t-- > from;)
                next = place(t) = Interval::join(b(t), Interval::meet(a(t), next));
            break;
        }
        case Kind::since: {
            Bounds before = from == 0 ? Interval::bottom : place(from - 1);
            for (Tick t = from; t < end; ++t)
                before = place(t) = Interval::join(b(t), Interval::meet(a(t), before));
            break;
        }
        case Kind::sum: {
            if (own.low <= -forever) {
                Bounds sum = from == 0 ? WindowSums::Add::identity : place(from - 1);
                for (Tick t = from; t < end; ++t) {
                    if (t + own.high >= 0) sum = WindowSums::Add::join(a(t + own.high), sum);
                    place(t) = sum;
                }
                break;
            }
            WindowSums sums(own.high - own.low + 1);
            for (Tick t = from; t < end; ++t)
                place(t) = t + own.high < 0 ? WindowSums::Add::identity : sums.at(t + own.high, a);
            break;
        }
        default: {
            const bool greatest = own.kind == Kind::greatest;
            const Bounds empty = greatest ? Interval::bottom : Interval::top;
            if (own.low <= -forever) {
                Bounds sum = from == 0 ? empty : place(from - 1);
                for (Tick t = from; t < end; ++t) {
                    if (t + own.high >= 0) sum = join(sum, a(t + own.high), greatest);
                    place(t) = sum;
                }
                break;
            }
            Sliding lower(greatest);
            Sliding upper(greatest);
            Tick next = std::max<Tick>(0, plus(from, own.low));
            for (Tick t = from; t < end; ++t) {
                for (const Tick last = std::min(end - 1, plus(t, own.high)); next <= last; ++next) {
                    const Bounds value = a(next);
                    lower.add(next, value.lower);
                    upper.add(next, value.upper);
                }
                place(t) = {lower.from(plus(t, own.low)), upper.from(plus(t, own.low))};
            }
        }
        }
    }
    std::vector<BoundsEngine::Rest> result;
    for (const std::uint32_t ref : refs) {
        Column& column = columns[ref / 2];
        BoundsEngine::Rest rest{column.first, {}};
        for (Tick t = column.first; t < end; ++t)
            rest.bounds.push_back(column.at(t, (ref & 1U) != 0));
        result.push_back(std::move(rest));
    }
    return result;
}

std::vector<BoundsEngine::Rest> BoundsEngine::ended(std::span<const std::uint32_t> refs, Tick end,
                                                    std::optional<Failure>* failure) const {
    std::vector<HeldNode> held;
    held.reserve(nodes_.size());
    for (const State& state : nodes_)
        held.push_back({state.keep, state.from, state.undefined.any, state.undefined.step});
    const auto value = [this](std::uint32_t ref, Tick t) { return at(ref, t); };
    return bounds_at_end(graph_, held, value, refs, end, failure);
}

} // namespace rtamt::early
