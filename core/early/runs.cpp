#include "runs.hpp"

#include "../values/real.hpp"

#include <algorithm>
#include <array>

namespace rtamt::early {

namespace {

// The least or the greatest of some values, in four lanes that do not wait for each other.
template <bool greatest>
[[nodiscard]] double extreme_of(const double* begin, const double* end) noexcept {
    constexpr std::size_t lanes = 4;
    const auto join = [](double a, double b) {
        return greatest ? Real::join(a, b) : Real::meet(a, b);
    };
    std::array<double, lanes> found{};
    found.fill(greatest ? -infinity : infinity);
    for (; end - begin >= static_cast<std::ptrdiff_t>(lanes); begin += lanes) {
        for (std::size_t i = 0; i < lanes; ++i)
            found[i] = join(found[i], begin[i]);
    }
    for (; begin != end; ++begin)
        found[0] = join(found[0], *begin);
    return join(join(found[0], found[1]), join(found[2], found[3]));
}

} // namespace

void Runs::sum(const Entry& entry) const noexcept {
    const Chunk& chunk = *entry.chunk;
    entry.summary.least = extreme_of<false>(chunk.value + chunk.begin, chunk.value + chunk.end);
    entry.summary.most = extreme_of<true>(chunk.value + chunk.begin, chunk.value + chunk.end);
    entry.summary.valid = true;
}

const Runs::Summary& Runs::group_from(std::size_t chunk) const noexcept {
    Summary& group = groups_[chunk / grouped];
    if (group.valid) return group;
    group = {infinity, -infinity, true};
    for (std::size_t c = chunk; c < chunk + grouped; ++c) {
        const Entry& entry = directory_[c];
        if (!entry.summary.valid) sum(entry);
        group.least = Real::meet(group.least, entry.summary.least);
        group.most = Real::join(group.most, entry.summary.most);
    }
    return group;
}

std::size_t Runs::not_below(std::size_t chunk, std::size_t end, double value) const noexcept {
    if (chunk % grouped == 0 && chunk + grouped <= end && group_from(chunk).least >= value)
        return grouped;
    const Entry& entry = directory_[chunk];
    if (!entry.summary.valid) sum(entry);
    return entry.summary.least >= value ? 1 : 0;
}

// From the end on, where most searches soon find what is enough.
template <bool greatest>
double Runs::extreme(Tick l, Tick r, double enough) const noexcept {
    double result = greatest ? -infinity : infinity;
    const auto take = [&](double value) noexcept { // whether it is enough
        result = greatest ? Real::join(result, value) : Real::meet(result, value);
        return greatest ? result >= enough : result <= enough;
    };
    const auto within = [&](const Chunk& chunk, int begin, int end) noexcept {
        return take(extreme_of<greatest>(chunk.value + begin, chunk.value + end));
    };
    const Place to = find(r);
    const Chunk& last = *directory_[to.chunk].chunk;
    if (take(last.value[to.index])) return result;
    if (directory_[to.chunk].first <= l || to.chunk == head_) {
        (void)within(last, find(l).index, to.index + 1);
        return result;
    }
    if (within(last, last.begin, to.index + 1)) return result;
    const Place from = find(l);
    for (std::size_t c = to.chunk - 1; c > from.chunk;) {
        if (c % grouped == grouped - 1 && c > from.chunk + grouped - 1) {
            const Summary& group = group_from(c + 1 - grouped);
            if (take(greatest ? group.most : group.least)) return result;
            c -= grouped;
            continue;
        }
        const Entry& entry = directory_[c--];
        if (!entry.summary.valid) sum(entry);
        if (take(greatest ? entry.summary.most : entry.summary.least)) return result;
    }
    const Chunk& first = *directory_[from.chunk].chunk;
    (void)within(first, from.index, first.end);
    return result;
}

double Runs::least(Tick l, Tick r, double floor) const noexcept {
    return extreme<false>(l, r, floor);
}

double Runs::most(Tick l, Tick r) const noexcept {
    return extreme<true>(l, r, infinity);
}

} // namespace rtamt::early
