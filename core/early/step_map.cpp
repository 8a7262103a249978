#include "step_map.hpp"

#include "../program/snapshot.hpp"
#include "../values/bounds.hpp"
#include "kleene_runs.hpp"

#include <algorithm>
#include <utility>

namespace rtamt::early {

template <class Value>
StepMap<Value>::StepMap(Tick from, const Value& value) {
    directory_.push_back(Entry{});
    append(from, value);
}

template <class Value>
StepMap<Value>::StepMap(const StepMap& other) {
    directory_.reserve(other.directory_.size() - other.head_);
    for (std::size_t c = other.head_; c < other.directory_.size(); ++c) {
        const Entry& entry = other.directory_[c];
        directory_.push_back({entry.first, entry.summary, std::make_unique<Chunk>(*entry.chunk)});
    }
    moved(0);
}

template <class Value>
auto StepMap<Value>::operator=(const StepMap& other) -> StepMap& {
    if (this != &other) *this = StepMap(other);
    return *this;
}

template <class Value>
auto StepMap<Value>::before(Place p) const noexcept -> std::optional<Place> {
    if (p.index > directory_[p.chunk].chunk->begin) return Place{p.chunk, p.index - 1};
    if (p.chunk == head_) return std::nullopt;
    return Place{p.chunk - 1, directory_[p.chunk - 1].chunk->end - 1};
}

template <class Value>
auto StepMap<Value>::after(Place p) const noexcept -> std::optional<Place> {
    if (p.index + 1 < directory_[p.chunk].chunk->end) return Place{p.chunk, p.index + 1};
    if (p.chunk + 1 == directory_.size()) return std::nullopt;
    return Place{p.chunk + 1, directory_[p.chunk + 1].chunk->begin};
}

// ---- changes ------------------------------------------------------------------------------------
// Which chunks there are from an index on is not what it was.
template <class Value>
void StepMap<Value>::moved(std::size_t chunk) {
    groups_.resize(directory_.size() / grouped);
    for (std::size_t g = chunk / grouped; g < groups_.size(); ++g)
        groups_[g].valid = false;
}

template <class Value>
void StepMap<Value>::set(Place p, Tick l, Tick r, const Value& value) {
    Entry& entry = directory_[p.chunk];
    const Value old = entry.chunk->value[p.index];
    if (old == value) return;
    changed(p.chunk);
    // Nearly always the runs before and after it lie in its chunk, which has room.
    Chunk& chunk = *entry.chunk;
    if ((p.index > chunk.begin || p.chunk == head_) && chunk.end + 2 <= capacity && r < forever &&
        (p.index + 1 < chunk.end || p.chunk + 1 == directory_.size())) {
        return replace(chunk, p.index, p.index + 1, std::max(l, chunk.start[p.index]), r, value,
                       old);
    }
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

template <class Value>
void StepMap<Value>::move_start(Place p, Tick start) noexcept {
    Entry& entry = directory_[p.chunk];
    entry.chunk->start[p.index] = start;
    if (p.index == entry.chunk->begin) entry.first = start;
}

template <class Value>
void StepMap<Value>::erase(Place p) noexcept {
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

template <class Value>
void StepMap<Value>::drop_empty(std::size_t from) noexcept {
    const auto is_empty = [](const Entry& entry) { return entry.chunk->begin == entry.chunk->end; };
    const auto begin = directory_.begin() + static_cast<std::ptrdiff_t>(from);
    directory_.erase(std::remove_if(begin, directory_.end(), is_empty), directory_.end());
    moved(from);
}

// Fills the last chunk, which has room.
template <class Value>
void StepMap<Value>::append(Tick start, const Value& value) {
    Entry& entry = directory_.back();
    if (!entry.chunk) entry.chunk = std::make_unique<Chunk>();
    Chunk& chunk = *entry.chunk;
    if (chunk.begin == chunk.end) entry.first = start;
    chunk.start[chunk.end] = start;
    chunk.value[chunk.end++] = value;
    changed(directory_.size() - 1);
}

template <class Value>
auto StepMap<Value>::insert_after(Place p, Tick start, const Value& value) -> Place {
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
            directory_[p.chunk].summary.valid = false;
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

template <class Value>
void StepMap<Value>::drop_before(Tick t) noexcept {
    for (; head_ + 1 < directory_.size() && directory_[head_ + 1].first <= t; ++head_)
        directory_[head_].chunk.reset();
    if (head_ > 0 && 2 * head_ >= directory_.size()) { // the others are not moved often
        directory_.erase(directory_.begin(),
                         directory_.begin() + static_cast<std::ptrdiff_t>(head_));
        head_ = 0;
        moved(0);
    }
    Entry& entry = directory_[head_];
    Chunk& chunk = *entry.chunk;
    const int begin = chunk.begin;
    while (chunk.begin + 1 < chunk.end && chunk.start[chunk.begin + 1] <= t)
        ++chunk.begin;
    entry.first = chunk.start[chunk.begin];
    if (chunk.begin != begin) changed(head_);
}

// ---- state --------------------------------------------------------------------------------------

namespace {

[[nodiscard]] bool is_sound(double value) noexcept {
    return value == value; // no NaN
}

[[nodiscard]] bool is_sound(const Bounds& value) noexcept {
    return value.lower <= value.upper;
}

[[nodiscard]] bool is_sound(Kleene value) noexcept {
    return value <= Kleene::fails;
}

} // namespace

template <class Value>
void StepMap<Value>::transfer(Snapshot& snapshot) {
    std::vector<Tick> starts;
    std::vector<Value> values;
    for (std::size_t c = head_; c < directory_.size(); ++c) {
        const Chunk& chunk = *directory_[c].chunk;
        starts.insert(starts.end(), chunk.start + chunk.begin, chunk.start + chunk.end);
        values.insert(values.end(), chunk.value + chunk.begin, chunk.value + chunk.end);
    }
    std::size_t size = starts.size();
    snapshot.count(size, sizeof(Tick) + sizeof(Value));
    snapshot.require(size > 0);
    starts.resize(size);
    values.resize(size);
    snapshot.values(starts.data(), size);
    snapshot.values(values.data(), size);
    if (!snapshot.loading()) return;
    directory_.clear();
    head_ = 0;
    for (std::size_t i = 0; i < size; ++i) {
        snapshot.require(starts[i] < forever && starts[i] > (i == 0 ? -1 : starts[i - 1]));
        snapshot.require(is_sound(values[i]));
        if (i % capacity == 0) directory_.emplace_back();
        append(starts[i], values[i]);
    }
    moved(0);
}

template class StepMap<double>;
template class StepMap<Bounds>;
template class StepMap<Kleene>;

} // namespace rtamt::early
