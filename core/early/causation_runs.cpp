#include "causation_runs.hpp"

#include "../values/algebra.hpp"

#include <algorithm>
#include <iterator>
#include <ranges>
#include <utility>

namespace rtamt::early {

void append(Pieces& pieces, Tick begin, Tick end, double value) {
    if (begin > end || value == -infinity) return;
    if (!pieces.empty() && pieces.back().end == begin - 1 && pieces.back().value == value) {
        pieces.back().end = end;
    } else {
        pieces.push_back({begin, end, value});
    }
}

void append(Pieces& pieces, const Runs& own, Tick l, Tick r) {
    while (l <= r) {
        const Run run = own.at(l);
        const Tick end = std::min(run.end, r);
        append(pieces, l, end, run.value);
        l = end + 1;
    }
}

void envelope(Pieces& pieces) {
    if (pieces.size() < 2) return;
    std::ranges::sort(pieces, {}, &Run::begin);
    Pieces heap; // of those that have begun, the greatest first
    const auto less = [](const Run& a, const Run& b) { return a.value < b.value; };
    Pieces result;
    Tick t = pieces.front().begin;
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

Pieces both(const Pieces& a, const Pieces& b) {
    Pieces result;
    for (auto x = a.begin(), y = b.begin(); x != a.end() && y != b.end();) {
        append(result, std::max(x->begin, y->begin), std::min(x->end, y->end),
               Real::meet(x->value, y->value));
        (x->end < y->end ? x : y)++;
    }
    return result;
}

void clip(Pieces& pieces, Tick last) {
    std::erase_if(pieces, [&](const Run& run) { return run.end < 0 || run.begin > last; });
    for (Run& run : pieces)
        run = {std::max<Tick>(0, run.begin), std::min(last, run.end), run.value};
}

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

void widen(Pieces& pieces, const Pieces& operand, Tick low, Tick high) {
    if (low > high) return;
    for (const Run& run : operand)
        pieces.push_back({plus(run.begin, -high), plus(run.end, -low), run.value});
}

Pieces shifted(Pieces pieces, Tick by) {
    for (Run& run : pieces)
        run = {plus(run.begin, by), plus(run.end, by), run.value};
    return pieces;
}

Pieces reversed(const Pieces& pieces) {
    Pieces result;
    result.reserve(pieces.size());
    for (const Run& run : std::views::reverse(pieces))
        result.push_back({-run.end, -run.begin, run.value});
    return result;
}

double value_at(const Pieces& pieces, Tick t) noexcept {
    const auto after = std::ranges::upper_bound(pieces, t, {}, &Run::begin);
    if (after == pieces.begin()) return -infinity;
    const Run& run = *std::prev(after);
    return t <= run.end ? run.value : -infinity;
}

double most(const Pieces& pieces, Tick from) noexcept {
    double result = -infinity;
    for (const Run& run : pieces) {
        if (run.end >= from) result = Real::join(result, run.value);
    }
    return result;
}

} // namespace rtamt::early
