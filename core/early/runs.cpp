#include "runs.hpp"

#include "../program/snapshot.hpp"
#include "../values/real.hpp"

#include <algorithm>
#include <array>
#include <iterator>

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

Runs::Runs(Tick from, double value) {
    directory_.push_back(Entry{});
    append(from, value);
}

Runs::Runs(const Runs& other) {
    directory_.reserve(other.directory_.size());
    for (const Entry& entry : other.directory_) {
        directory_.push_back({entry.first, entry.least, entry.most, entry.summed,
                              std::make_unique<Chunk>(*entry.chunk)});
    }
    moved(0);
}

Runs& Runs::operator=(const Runs& other) {
    if (this != &other) *this = Runs(other);
    return *this;
}

std::optional<Runs::Place> Runs::before(Place p) const noexcept {
    if (p.index > directory_[p.chunk].chunk->begin) return Place{p.chunk, p.index - 1};
    if (p.chunk == 0) return std::nullopt;
    return Place{p.chunk - 1, directory_[p.chunk - 1].chunk->end - 1};
}

std::optional<Runs::Place> Runs::after(Place p) const noexcept {
    if (p.index + 1 < directory_[p.chunk].chunk->end) return Place{p.chunk, p.index + 1};
    if (p.chunk + 1 == directory_.size()) return std::nullopt;
    return Place{p.chunk + 1, directory_[p.chunk + 1].chunk->begin};
}

// ---- changes ------------------------------------------------------------------------------------

// What the values of a chunk are, or which chunks there are from an index on, is not what it was.
void Runs::changed(std::size_t chunk) noexcept {
    directory_[chunk].summed = false;
    if (chunk / grouped < groups_.size()) groups_[chunk / grouped].summed = false;
}

void Runs::moved(std::size_t chunk) {
    groups_.resize(directory_.size() / grouped);
    for (std::size_t g = chunk / grouped; g < groups_.size(); ++g)
        groups_[g].summed = false;
}

void Runs::set(Place p, Tick l, Tick r, double value) {
    Entry& entry = directory_[p.chunk];
    const double old = entry.chunk->value[p.index];
    if (old == value) return;
    changed(p.chunk);
    const bool from_begin = l <= entry.chunk->start[p.index];
    const bool to_end = r >= end_of(p);
    const auto left = from_begin ? before(p) : std::nullopt;
    const auto right = to_end ? after(p) : std::nullopt;
    const bool joins_left = left && value_at(*left) == value;
    const bool joins_right = right && value_at(*right) == value;
    if (from_begin && to_end) {
        if (joins_right) erase(*right); // the later one first: places before it stay
        if (joins_left) {
            erase(p);
        } else {
            value_at(p) = value;
        }
    } else if (from_begin) {
        if (joins_left) {
            move_start(p, r + 1);
        } else {
            value_at(p) = value;
            insert_after(p, r + 1, old);
        }
    } else if (to_end) {
        if (joins_right) {
            move_start(*right, l);
        } else {
            insert_after(p, l, value);
        }
    } else {
        insert_after(insert_after(p, l, value), r + 1, old);
    }
}

void Runs::move_start(Place p, Tick start) noexcept {
    Entry& entry = directory_[p.chunk];
    entry.chunk->start[p.index] = start;
    if (p.index == entry.chunk->begin) entry.first = start;
}

void Runs::erase(Place p) noexcept {
    Entry& entry = directory_[p.chunk];
    Chunk& chunk = *entry.chunk;
    changed(p.chunk);
    if (p.index == chunk.begin) {
        ++chunk.begin;
        if (chunk.begin < chunk.end) entry.first = chunk.start[chunk.begin];
    } else {
        std::copy(chunk.start + p.index + 1, chunk.start + chunk.end, chunk.start + p.index);
        std::copy(chunk.value + p.index + 1, chunk.value + chunk.end, chunk.value + p.index);
        --chunk.end;
    }
    if (chunk.begin == chunk.end) {
        directory_.erase(directory_.begin() + static_cast<std::ptrdiff_t>(p.chunk));
        moved(p.chunk);
    }
}

// Fills the last chunk, which has room.
void Runs::append(Tick start, double value) {
    Entry& entry = directory_.back();
    if (!entry.chunk) entry.chunk = std::make_unique<Chunk>();
    Chunk& chunk = *entry.chunk;
    if (chunk.begin == chunk.end) entry.first = start;
    chunk.start[chunk.end] = start;
    chunk.value[chunk.end++] = value;
    changed(directory_.size() - 1);
}

Runs::Place Runs::insert_after(Place p, Tick start, double value) {
    if (directory_[p.chunk].chunk->end == capacity) {
        Chunk& full = *directory_[p.chunk].chunk;
        if (full.begin > 0) { // there is room at its front
            std::copy(full.start + full.begin, full.start + full.end, full.start);
            std::copy(full.value + full.begin, full.value + full.end, full.value);
            p.index -= full.begin;
            full.end -= full.begin;
            full.begin = 0;
        } else {
            // What grows at the end leaves full chunks behind, anything else halves.
            const bool grows = p.chunk + 1 == directory_.size() && p.index + 1 == capacity;
            const int kept = grows ? capacity : capacity / 2;
            Entry upper;
            upper.chunk = std::make_unique<Chunk>();
            std::copy(full.start + kept, full.start + full.end, upper.chunk->start);
            std::copy(full.value + kept, full.value + full.end, upper.chunk->value);
            upper.chunk->end = full.end - kept;
            upper.first = grows ? start : upper.chunk->start[0];
            full.end = kept;
            directory_[p.chunk].summed = false;
            directory_.insert(directory_.begin() + static_cast<std::ptrdiff_t>(p.chunk) + 1,
                              std::move(upper));
            moved(p.chunk);
            if (grows) {
                append(start, value);
                return {p.chunk + 1, 0};
            }
            if (p.index >= kept) p = {p.chunk + 1, p.index - kept};
        }
    }
    Entry& entry = directory_[p.chunk];
    Chunk& chunk = *entry.chunk;
    const int place = p.index + 1;
    std::copy_backward(chunk.start + place, chunk.start + chunk.end, chunk.start + chunk.end + 1);
    std::copy_backward(chunk.value + place, chunk.value + chunk.end, chunk.value + chunk.end + 1);
    chunk.start[place] = start;
    chunk.value[place] = value;
    ++chunk.end;
    changed(p.chunk);
    return {p.chunk, place};
}

void Runs::drop_before(Tick t) noexcept {
    std::size_t whole = 0; // chunks
    while (whole + 1 < directory_.size() && directory_[whole + 1].first <= t)
        ++whole;
    if (whole > 0) {
        directory_.erase(directory_.begin(),
                         directory_.begin() + static_cast<std::ptrdiff_t>(whole));
        moved(0);
    }
    Entry& entry = directory_.front();
    Chunk& chunk = *entry.chunk;
    const int begin = chunk.begin;
    while (chunk.begin + 1 < chunk.end && chunk.start[chunk.begin + 1] <= t)
        ++chunk.begin;
    entry.first = chunk.start[chunk.begin];
    if (chunk.begin != begin) changed(0);
}

// ---- extremes -----------------------------------------------------------------------------------

void Runs::sum(const Entry& entry) const noexcept {
    const Chunk& chunk = *entry.chunk;
    entry.least = extreme_of<false>(chunk.value + chunk.begin, chunk.value + chunk.end);
    entry.most = extreme_of<true>(chunk.value + chunk.begin, chunk.value + chunk.end);
    entry.summed = true;
}

const Runs::Group& Runs::group_from(std::size_t chunk) const noexcept {
    Group& group = groups_[chunk / grouped];
    if (group.summed) return group;
    group = {infinity, -infinity, true};
    for (std::size_t c = chunk; c < chunk + grouped; ++c) {
        const Entry& entry = directory_[c];
        if (!entry.summed) sum(entry);
        group.least = Real::meet(group.least, entry.least);
        group.most = Real::join(group.most, entry.most);
    }
    return group;
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
    if (directory_[to.chunk].first <= l || to.chunk == 0) {
        (void)within(last, find(l).index, to.index + 1);
        return result;
    }
    if (within(last, last.begin, to.index + 1)) return result;
    const Place from = find(l);
    for (std::size_t c = to.chunk - 1; c > from.chunk;) {
        if (c % grouped == grouped - 1 && c > from.chunk + grouped - 1) {
            const Group& group = group_from(c + 1 - grouped);
            if (take(greatest ? group.most : group.least)) return result;
            c -= grouped;
            continue;
        }
        const Entry& entry = directory_[c--];
        if (!entry.summed) sum(entry);
        if (take(greatest ? entry.most : entry.least)) return result;
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

// ---- state --------------------------------------------------------------------------------------

void Runs::transfer(Snapshot& snapshot) {
    std::vector<Tick> starts;
    std::vector<double> values;
    for (const Entry& entry : directory_) {
        const Chunk& chunk = *entry.chunk;
        starts.insert(starts.end(), chunk.start + chunk.begin, chunk.start + chunk.end);
        values.insert(values.end(), chunk.value + chunk.begin, chunk.value + chunk.end);
    }
    std::size_t size = starts.size();
    snapshot.count(size, sizeof(Tick) + sizeof(double));
    snapshot.require(size > 0);
    starts.resize(size);
    values.resize(size);
    snapshot.values(starts.data(), size);
    snapshot.values(values.data(), size);
    if (!snapshot.loading()) return;
    directory_.clear();
    for (std::size_t i = 0; i < size; ++i) {
        snapshot.require(starts[i] < forever && (i == 0 || starts[i - 1] < starts[i]));
        snapshot.require(values[i] == values[i]); // no NaN
        if (i % capacity == 0) directory_.emplace_back();
        append(starts[i], values[i]);
    }
    moved(0);
}

} // namespace rtamt::early
