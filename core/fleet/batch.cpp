// Batches and keys: what is checked before a record changes, and how a batch is undone. What runs
// is in fleet.cpp.
#include "fleet.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace rtamt::fleet {

std::optional<Rejected> Fleet::update(const Batch& batch, std::span<const Output> outputs) {
    const std::size_t count = batch.size();
    if (count == 0) return std::nullopt;
    require_fitting(batch, keys_);
    const std::size_t old_size = size();
    try {
        return take(batch, outputs, old_size);
    } catch (...) { // before a record has changed
        forget_from(old_size);
        throw;
    }
}

std::optional<Rejected> Fleet::take(const Batch& batch, std::span<const Output> outputs,
                                    std::size_t old_size) {
    const std::size_t count = batch.size();
    auto wrong = wrong_value(batch);
    const std::size_t checked = wrong ? wrong->index + 1 : count;
    places_.resize(count);
    const auto bad_key = batch.keys.kind == KeyKind::integer
                             ? admit(batch.keys.integers, batch, checked)
                             : admit(batch.keys.texts, batch, checked);
    if (bad_key) wrong = bad_key; // its index is not greater, and a time comes before a value
    if (wrong) {
        describe(*wrong, batch);
        forget_from(old_size);
        return wrong;
    }
    if (guarded_state_) save(count, old_size);
    wrong = run(batch, outputs);
    if (wrong) {
        if (guarded_state_) put_back(count, old_size);
        forget_from(old_size);
    }
    return wrong;
}

// Finds the places of the first keys of a batch, of new ones too, and checks their times.
template <class Key>
std::optional<Rejected> Fleet::admit(std::span<const Key> keys, const Batch& batch,
                                     std::size_t count) {
    if (marks_ > Keys::none - 2 - count) {
        keys_.clear_marks();
        marks_ = 0;
    }
    const std::uint32_t base = marks_;
    marks_ += static_cast<std::uint32_t>(count);
    std::array<std::uint64_t, 2 * block_size> codes{};
    std::array<std::uint32_t, block_size> before{}; // index + 1 of the sample before; 0: none
    std::uint32_t most = 0;
    turns_.clear();
    const auto request = [&](std::size_t first) { // the next block, while this one is looked at
        for (std::size_t i = first; i < std::min(first + block_size, count); ++i) {
            codes[i % codes.size()] = keys_.code(keys[i]);
            keys_.request(codes[i % codes.size()]);
        }
    };
    request(0);
    for (std::size_t first = 0; first < count; first += block_size) {
        const std::size_t size = std::min(block_size, count - first);
        request(first + block_size);
        for (std::size_t i = 0; i < size; ++i) {
            const std::size_t index = first + i;
            Keys::Entry* entry = keys_.find(keys[index], codes[index % codes.size()]);
            if (entry == nullptr) [[unlikely]] {
                if (this->size() == settings_.capacity) {
                    return Rejected{index, Rejected::Reason::full};
                }
                layout_.start(record(this->size()));
                entry = keys_.add(keys[index], codes[index % codes.size()]);
            }
            places_[index] = entry->place;
            prefetch(record(entry->place));
            before[i] = entry->mark > base ? entry->mark - base : 0;
            entry->mark = base + static_cast<std::uint32_t>(index) + 1;
            if (before[i] != 0 && turns_.empty()) turns_.assign(batch.size(), 0);
            if (!turns_.empty() && before[i] != 0) {
                most = std::max(most, turns_[index] = turns_[before[i] - 1] + 1);
            }
        }
        for (std::size_t i = 0; i < size; ++i) {
            const std::size_t index = first + i;
            const double time = batch.times[index];
            const Header& header = Layout::header(record(places_[index]));
            const bool begins = before[i] == 0 && header.samples == 0;
            const double last = before[i] == 0 ? header.last : batch.times[before[i] - 1];
            if (std::isfinite(time) && (begins || fits(time - last))) [[likely]] {
                continue;
            }
            const bool later = std::isfinite(time) && time > last;
            // A trace begins again where there is a gap, not where there may be one.
            if (later && settings_.restart && !may_fit(time - last, time)) continue;
            return Rejected{index, later ? Rejected::Reason::gap : Rejected::Reason::time};
        }
    }
    take_turns(count, most);
    return std::nullopt;
}

// What its key knew before the sample that is wrong; the samples before it are admitted.
void Fleet::describe(Rejected& wrong, const Batch& batch) {
    if (wrong.reason == Rejected::Reason::full) return;
    const std::uint32_t place = places_[wrong.index];
    const Header& header = Layout::header(record(place));
    wrong.samples = header.samples;
    if (header.samples != 0) wrong.last = header.last;
    for (std::size_t i = 0; i < wrong.index; ++i) {
        if (places_[i] != place) continue;
        const bool again = wrong.last && settings_.restart && !fits(batch.times[i] - *wrong.last);
        wrong.samples = again ? 1 : wrong.samples + 1;
        wrong.last = batch.times[i];
    }
}

// Sorts the samples by the number of earlier ones of their key, if a key occurs twice.
void Fleet::take_turns(std::size_t count, std::uint32_t most) {
    rounds_.clear();
    order_.clear();
    if (most == 0) return;
    rounds_.assign(std::size_t{most} + 1, 0);
    for (std::size_t i = 0; i < count; ++i)
        ++rounds_[turns_[i]];
    std::vector<std::size_t> next(rounds_.size());
    for (std::size_t round = 1; round < rounds_.size(); ++round) {
        next[round] = rounds_[round - 1];
        rounds_[round] += rounds_[round - 1];
    }
    order_.resize(count);
    for (std::size_t i = 0; i < count; ++i)
        order_[next[turns_[i]]++] = static_cast<std::uint32_t>(i);
}

// ---- rollback -----------------------------------------------------------------------------------

// Copies the records of a batch, each before its key's first sample.
void Fleet::save(std::size_t count, std::size_t old_size) {
    saved_.clear();
    for (std::size_t i = 0; i < count; ++i) {
        if (places_[i] >= old_size || (!turns_.empty() && turns_[i] != 0)) continue;
        const std::byte* here = record(places_[i]);
        saved_.insert(saved_.end(), here, here + layout_.record_size());
    }
}

void Fleet::put_back(std::size_t count, std::size_t old_size) noexcept {
    const std::byte* next = saved_.data();
    for (std::size_t i = 0; i < count; ++i) {
        if (places_[i] >= old_size || (!turns_.empty() && turns_[i] != 0)) continue;
        std::memcpy(record(places_[i]), next, layout_.record_size());
        next += layout_.record_size();
    }
}

// ---- keys ---------------------------------------------------------------------------------------

std::optional<std::size_t> Fleet::drop(const KeySpan& keys) {
    for (std::size_t i = 0; i < keys.size(); ++i) {
        if (!place_of(keys, i)) return i;
    }
    for (std::size_t i = 0; i < keys.size(); ++i) {
        if (const auto place = place_of(keys, i)) erase(*place); // the same key may occur again
    }
    return std::nullopt;
}

std::size_t Fleet::expire(double before) {
    const std::size_t old_size = size();
    for (std::size_t place = old_size; place-- > 0;) {
        if (Layout::header(record(place)).last < before) erase(static_cast<std::uint32_t>(place));
    }
    return old_size - size();
}

std::optional<std::uint32_t> Fleet::place_of(const KeySpan& keys, std::size_t index) noexcept {
    if (keys.kind != keys_.kind()) return std::nullopt;
    const auto place = [&](auto key) -> std::optional<std::uint32_t> {
        const Keys::Entry* entry = keys_.find(key, keys_.code(key));
        return entry == nullptr ? std::nullopt : std::optional(entry->place);
    };
    return keys.kind == KeyKind::integer ? place(keys.integers[index]) : place(keys.texts[index]);
}

// Forgets the key at a place, which the last one takes. Unused records are zero.
void Fleet::erase(std::uint32_t place) noexcept {
    keys_.erase(place);
    std::byte* last = record(size());
    if (place != size()) std::memcpy(record(place), last, layout_.record_size());
    std::memset(last, 0, layout_.record_size());
}

void Fleet::forget_from(std::size_t old_size) noexcept {
    while (size() > old_size)
        erase(static_cast<std::uint32_t>(size() - 1));
}

} // namespace rtamt::fleet
