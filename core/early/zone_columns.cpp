// The columns of the zone engine: every node from those of its operands, a register at a time.
#include "zone_engine.hpp"

#include <algorithm>

namespace rtamt::early {

namespace {

// Whether a register of a node takes the greatest of its operands.
[[nodiscard]] bool takes_greatest(Kind kind, int reg) noexcept {
    return (kind != Kind::both && kind != Kind::least) == (reg == 0);
}

// The greatest of two values in a register that takes it, else the least.
template <bool up>
[[nodiscard]] double best(double a, double b) noexcept {
    return up ? Real::join(a, b) : Real::meet(a, b);
}

template <bool up>
void combine(const double* a, const double* b, std::size_t n, double* out) noexcept {
    for (std::size_t i = 0; i < n; ++i)
        out[i] = best<up>(a[i], b[i]);
}

// The best of `width` values from each of n places on; `x` holds n + width - 1 and is overwritten.
template <bool up>
void slide(double* x, std::size_t width, std::size_t n, double* out) noexcept {
    std::size_t covered = 1;
    for (std::size_t rest = n + width - 1; 2 * covered <= width; covered *= 2) {
        rest -= covered;
        combine<up>(x, x + covered, rest, x);
    }
    combine<up>(x, x + (width - covered), n, out);
}

// The best of all values so far and a value before them.
template <bool up>
void accumulate(double before, const double* x, std::size_t n, double* out) noexcept {
    for (std::size_t i = 0; i < n; ++i)
        out[i] = before = best<up>(before, x[i]);
}

// max(goal, min(hold, value before)), or the dual.
template <bool up>
void since(double before, const double* hold, const double* goal, std::size_t n,
           double* out) noexcept {
    for (std::size_t i = 0; i < n; ++i)
        out[i] = before = best<up>(goal[i], best<!up>(hold[i], before));
}

template <bool up>
void until(double next, const double* hold, const double* goal, std::size_t n,
           double* out) noexcept {
    for (std::size_t i = n; i-- > 0;)
        out[i] = next = best<up>(goal[i], best<!up>(hold[i], next));
}

} // namespace

void ZoneEngine::compute() {
    for (std::size_t i = 0; i < columns_.size(); ++i) {
        const Node& node = graph_.nodes[i];
        if (node.kind == Kind::atom) continue;
        Column& own = columns_[i];
        const Tick first = std::max(own.first, newest_ - reach_[i].behind);
        if (is_recursive(node) && first > own.first)
            own.before = {own.values[0][0], own.values[1][0]};
        own.first = first;
        const Tick last = newest_ + (ended_ ? 0 : reach_[i].ahead);
        for (int reg = 0; reg < 2; ++reg) {
            own.values[static_cast<std::size_t>(reg)].resize(
                static_cast<std::size_t>(last - first + 1));
            takes_greatest(node.kind, reg) ? compute<true>(i, reg) : compute<false>(i, reg);
        }
    }
    if (start_ && columns_[start_->a / 2].first == 0) {
        const Bounds value = bounds_of(columns_[start_->a / 2], start_->a, 0);
        at_start_ = start_->negated ? Interval::neg(value) : value;
    }
}

template <bool up>
void ZoneEngine::compute(std::size_t index, int reg) {
    const Node& node = graph_.nodes[index];
    Column& own = columns_[index];
    auto& values = own.values[static_cast<std::size_t>(reg)];
    double& rest = own.rest[static_cast<std::size_t>(reg)];
    double* out = values.data();
    const std::size_t n = values.size();
    constexpr double empty = up ? -infinity : infinity;
    const double before = own.first == 0 ? empty : own.before[static_cast<std::size_t>(reg)];
    const double a_rest = rest_of(node.a, reg);
    const Tick first = own.first;
    switch (node.kind) {
    case Kind::both:
    case Kind::either:
        combine<up>(read(node.a, reg, first, n, empty, 0), read(node.b, reg, first, n, empty, 1), n,
                    out);
        rest = best<up>(a_rest, rest_of(node.b, reg));
        break;
    case Kind::until:
        rest = rest_of(node.b, reg);
        until<up>(ended_ ? empty : rest, read(node.a, reg, first, n, empty, 0),
                  read(node.b, reg, first, n, empty, 1), n, out);
        break;
    case Kind::since:
        since<up>(before, read(node.a, reg, first, n, empty, 0),
                  read(node.b, reg, first, n, empty, 1), n, out);
        rest = best<up>(rest_of(node.b, reg), best<!up>(a_rest, n > 0 ? out[n - 1] : before));
        break;
    default:
        if (is_unbounded(node)) {
            accumulate<up>(before, read(node.a, reg, first + node.high, n, empty, 0), n, out);
            rest = best<up>(n > 0 ? out[n - 1] : before, a_rest);
        } else {
            const auto width = static_cast<std::size_t>(node.high - node.low + 1);
            slide<up>(copied(node.a, reg, first + node.low, n + width - 1, empty), width, n, out);
            rest = a_rest;
        }
    }
}

double ZoneEngine::rest_of(std::uint32_t ref, int reg) const noexcept {
    return columns_[ref / 2].rest[static_cast<std::size_t>(reg) ^ (ref & 1U)];
}

// The values of a register at n ticks from l on: `empty` before the trace and after its end.
const double* ZoneEngine::read(std::uint32_t ref, int reg, Tick l, std::size_t n, double empty,
                               std::size_t scratch) {
    const Column& column = columns_[ref / 2];
    const auto& values = column.values[static_cast<std::size_t>(reg) ^ (ref & 1U)];
    const auto last = l + static_cast<Tick>(n);
    if (l >= column.first && last <= column.first + static_cast<Tick>(values.size()))
        return values.data() + (l - column.first);
    return copied(ref, reg, l, n, empty, scratch);
}

double* ZoneEngine::copied(std::uint32_t ref, int reg, Tick l, std::size_t n, double empty,
                           std::size_t scratch) {
    const Column& column = columns_[ref / 2];
    const auto& values = column.values[static_cast<std::size_t>(reg) ^ (ref & 1U)];
    auto& out = scratch_[scratch];
    out.resize(std::max(out.size(), n));
    const auto end = static_cast<Tick>(n);
    const Tick begins = std::clamp<Tick>(column.first - l, 0, end);
    const Tick ends = std::clamp<Tick>(
        begins == 0 ? column.first - l + std::ssize(values) : begins + std::ssize(values), 0, end);
    std::fill(out.begin(), out.begin() + begins, empty);
    if (ends > begins)
        std::copy_n(values.begin() + (l + begins - column.first), ends - begins,
                    out.begin() + begins);
    std::fill(out.begin() + std::max(begins, ends), out.begin() + end,
              ended_ ? empty : rest_of(ref, reg));
    return out.data();
}

} // namespace rtamt::early
