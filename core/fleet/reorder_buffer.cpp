#include "reorder_buffer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace rtamt::fleet {

namespace {

// Times of a sum of whole periods and of clocks differ in the last digits: a sample that is as
// late as is allowed is not late.
constexpr double rounding = 4 * std::numeric_limits<double>::epsilon();

} // namespace

ReorderBuffer::ReorderBuffer(std::vector<std::string> names, const Settings& settings)
    : names_(std::move(names)), settings_(settings), slack_(settings.tolerance * settings.period) {
    ready_.columns.resize(inputs());
}

double ReorderBuffer::watermark_of(const Line& line) const noexcept {
    return std::max(watermark_,
                    settings_.lateness ? line.newest - *settings_.lateness : line.newest);
}

bool ReorderBuffer::is_late(const Line& line, double time) const noexcept {
    if (time <= line.left) return true;
    const double watermark = watermark_of(line);
    return std::isfinite(watermark) ? time < watermark - rounding * std::fabs(watermark)
                                    : time < watermark;
}

// ---- a batch ------------------------------------------------------------------------------------

void ReorderBuffer::begin() {
    ++number_;
    old_size_ = size();
    old_late_ = late_;
    old_watermark_ = watermark_;
    saved_.clear();
    saved_waiting_.clear();
    saved_held_.clear();
    added_.clear();
    gone_.clear();
    ready_.places.clear();
    ready_.own.clear();
    ready_.fills.clear();
    ready_.times.clear();
    for (auto& column : ready_.columns)
        column.clear();
}

std::optional<Rejected> ReorderBuffer::offer(const Batch& batch, std::uint8_t* late) {
    begin();
    if (batch.size() == 0) return std::nullopt;
    require_fitting(batch, keys_);
    auto wrong = wrong_value(batch);
    for (std::size_t i = 0; i < (wrong ? wrong->index + 1 : batch.size()); ++i) {
        if (!std::isfinite(batch.times[i])) {
            wrong = Rejected{i, Rejected::Reason::time};
            break;
        }
    }
    if (wrong) return wrong;
    std::fill_n(late, batch.size(), std::uint8_t{0});
    try {
        wrong = batch.keys.kind == KeyKind::integer ? offer_all(batch.keys.integers, batch, late)
                                                    : offer_all(batch.keys.texts, batch, late);
    } catch (...) {
        withdraw();
        throw;
    }
    if (wrong) withdraw();
    return wrong;
}

template <class Key>
std::optional<Rejected> ReorderBuffer::offer_all(std::span<const Key> keys, const Batch& batch,
                                                 std::uint8_t* late) {
    std::array<std::uint64_t, block_size> codes{};
    std::array<std::uint32_t, block_size> places{};
    for (std::size_t first = 0; first < keys.size(); first += block_size) {
        const std::size_t count = std::min(block_size, keys.size() - first);
        for (std::size_t i = 0; i < count; ++i) {
            codes[i] = keys_.code(keys[first + i]);
            keys_.request(codes[i]);
        }
        for (std::size_t i = 0; i < count; ++i) {
            const Keys::Entry* entry = keys_.find(keys[first + i], codes[i]);
            if (entry == nullptr) [[unlikely]] {
                if (size() == settings_.capacity) {
                    return Rejected{first + i, Rejected::Reason::full};
                }
                lines_.emplace_back();
                if (settings_.filled != 0) held_.resize(size() * inputs());
                entry = keys_.add(keys[first + i], codes[i]);
            }
            places[i] = entry->place;
            prefetch(&lines_[entry->place]);
        }
        for (std::size_t i = 0; i < count; ++i) {
            auto wrong = offer_one(batch, first + i, places[i], late[first + i]);
            if (wrong) return wrong;
        }
    }
    return std::nullopt;
}

std::optional<Rejected> ReorderBuffer::offer_one(const Batch& batch, std::size_t index,
                                                 std::uint32_t place, std::uint8_t& late) {
    const double time = batch.times[index];
    Line& line = lines_[place];
    const auto divert = [&]() -> std::optional<Rejected> {
        if (!settings_.lateness) {
            return Rejected{index, Rejected::Reason::time, 0, line.newest, 0, time};
        }
        late = 1;
        ++late_;
        return std::nullopt;
    };
    if (is_late(line, time)) return divert();
    touch(place);
    const bool newest = time > line.newest;
    if (newest) line.newest = time;
    const auto at = static_cast<std::int64_t>(index);
    if (line.first == nothing && time <= watermark_of(line)) {
        return leave(place, at, true, time,
                     [&](std::size_t input) { return batch.columns[input][index]; });
    }
    if (!wait(line, time, batch, index)) return divert();
    return release(place, at, watermark_of(line));
}

// Remembers how a key was before the batch.
void ReorderBuffer::touch(std::uint32_t place) {
    Line& line = lines_[place];
    if (line.touched == number_ || place >= old_size_) return;
    for (std::uint32_t at = line.first; at != nothing; at = next_[at])
        saved_waiting_.push_back(at);
    saved_.push_back({place, line, saved_waiting_.size()});
    if (settings_.filled != 0) {
        const double* held = held_.data() + place * inputs();
        saved_held_.insert(saved_held_.end(), held, held + inputs());
    }
    line.touched = number_;
}

std::uint32_t ReorderBuffer::make_room() {
    if (free_.empty()) {
        const std::size_t count = times_.size();
        if (count >= nothing) throw std::bad_alloc();
        if (free_.capacity() <= count) free_.reserve(2 * count + block_size);
        values_.resize((count + 1) * inputs());
        next_.resize(count + 1, nothing);
        origin_.resize(count + 1, -1);
        times_.resize(count + 1);
        free_.push_back(static_cast<std::uint32_t>(count));
    }
    const std::uint32_t made = free_.back();
    added_.push_back(made);
    free_.pop_back();
    return made;
}

// Has a sample wait; returns false if one of this time waits already.
bool ReorderBuffer::wait(Line& line, double time, const Batch& batch, std::size_t index) {
    std::uint32_t before = nothing;
    if (line.last != nothing && times_[line.last] <= time) {
        before = line.last;
    } else {
        for (std::uint32_t at = line.first; at != nothing && times_[at] <= time; at = next_[at])
            before = at;
    }
    if (before != nothing && times_[before] == time) return false;
    const std::uint32_t made = make_room();
    times_[made] = time;
    origin_[made] = static_cast<std::int64_t>(index);
    for (std::size_t input = 0; input < inputs(); ++input)
        values_[made * inputs() + input] = batch.columns[input][index];
    std::uint32_t& link = before == nothing ? line.first : next_[before];
    next_[made] = link;
    link = made;
    if (next_[made] == nothing) line.last = made;
    return true;
}

// Lets leave what a watermark of a key has reached; `at`: the place in the batch.
std::optional<Rejected> ReorderBuffer::release(std::uint32_t place, std::int64_t at,
                                               double watermark) {
    Line& line = lines_[place];
    while (line.first != nothing && times_[line.first] <= watermark) {
        const std::uint32_t first = line.first;
        gone_.push_back(first);
        line.first = next_[first];
        if (line.first == nothing) line.last = nothing;
        const double* values = values_.data() + first * inputs();
        const bool own = origin_[first] >= 0;
        auto wrong = leave(place, own ? origin_[first] : at, own, times_[first],
                           [&](std::size_t input) { return values[input]; });
        if (wrong) return wrong;
    }
    return std::nullopt;
}

// Lets a sample leave, after the values that fill the gap before it.
template <class Value>
std::optional<Rejected> ReorderBuffer::leave(std::uint32_t place, std::int64_t at, bool own,
                                             double time, Value&& value) {
    Line& line = lines_[place];
    const auto add = [&](bool fills, double when, auto&& of) {
        ready_.places.push_back(at);
        ready_.own.push_back(static_cast<std::uint8_t>(own && !fills));
        ready_.fills.push_back(static_cast<std::uint8_t>(fills));
        ready_.times.push_back(when);
        for (std::size_t input = 0; input < inputs(); ++input)
            ready_.columns[input].push_back(of(input));
    };
    if (settings_.filled != 0) {
        double* held = held_.data() + place * inputs();
        const double gap = time - line.left;
        const double periods = std::round(gap / settings_.period);
        const bool known =
            std::none_of(held, held + inputs(), [](double x) { return std::isnan(x); });
        if (line.left != never && known && periods > 1.0 &&
            std::fabs(gap - periods * settings_.period) <= periods * slack_) {
            if (periods - 1.0 > static_cast<double>(settings_.filled)) {
                return Rejected{
                    static_cast<std::size_t>(at), Rejected::Reason::gap, 0, line.left, 0, time};
            }
            const auto steps = static_cast<std::size_t>(periods);
            for (std::size_t step = 1; step < steps; ++step)
                add(true, line.left + static_cast<double>(step) * (gap / periods),
                    [&](std::size_t input) { return held[input]; });
        }
        for (std::size_t input = 0; input < inputs(); ++input)
            held[input] = value(input);
    }
    line.left = time;
    add(false, time, value);
    return std::nullopt;
}

// Changes lines by visit(), which returns why that is impossible; then nothing has changed.
template <class Visit>
std::optional<Rejected> ReorderBuffer::without_samples(Visit&& visit) {
    begin();
    std::optional<Rejected> wrong;
    try {
        wrong = std::forward<Visit>(visit)();
    } catch (...) {
        withdraw();
        throw;
    }
    if (wrong) withdraw();
    return wrong;
}

std::optional<Rejected> ReorderBuffer::advance(double watermark) {
    return without_samples([&]() -> std::optional<Rejected> {
        watermark_ = std::max(watermark_, watermark);
        for (std::uint32_t place = 0; place < size(); ++place) {
            const Line& line = lines_[place];
            if (line.first == nothing || times_[line.first] > watermark_) continue;
            touch(place);
            if (auto wrong = release(place, place, watermark_of(line))) return wrong;
        }
        return std::nullopt;
    });
}

std::optional<Rejected> ReorderBuffer::release(const KeySpan& keys) {
    return without_samples([&]() -> std::optional<Rejected> {
        for (std::size_t i = 0; i < keys.size(); ++i) {
            const auto place = place_of(keys, i);
            if (!place) continue;
            touch(*place);
            if (auto wrong = release(*place, *place, -never)) return wrong;
        }
        return std::nullopt;
    });
}

void ReorderBuffer::accept() noexcept {
    for (const std::uint32_t added : added_)
        origin_[added] = -1;
    for (const std::uint32_t gone : gone_)
        free_.push_back(gone); // there is room for all
}

void ReorderBuffer::withdraw() noexcept {
    std::size_t begin = 0;
    const double* held = saved_held_.data();
    for (const Saved& saved : saved_) {
        Line& line = lines_[saved.place];
        line = saved.line;
        for (std::size_t i = begin; i < saved.end; ++i)
            next_[saved_waiting_[i]] = i + 1 < saved.end ? saved_waiting_[i + 1] : nothing;
        begin = saved.end;
        if (settings_.filled == 0) continue;
        std::copy_n(held, inputs(), held_.data() + saved.place * inputs());
        held += inputs();
    }
    for (const std::uint32_t added : added_) {
        origin_[added] = -1;
        free_.push_back(added);
    }
    while (keys_.size() > old_size_)
        keys_.erase(static_cast<std::uint32_t>(keys_.size() - 1));
    lines_.resize(old_size_);
    if (settings_.filled != 0) held_.resize(size() * inputs());
    late_ = old_late_;
    watermark_ = old_watermark_;
}

// ---- keys ---------------------------------------------------------------------------------------

std::optional<std::uint32_t> ReorderBuffer::place_of(const KeySpan& keys, std::size_t index) {
    if (keys.kind != keys_.kind()) return std::nullopt;
    const auto place = [&](auto key) -> std::optional<std::uint32_t> {
        const Keys::Entry* entry = keys_.find(key, keys_.code(key));
        return entry == nullptr ? std::nullopt : std::optional(entry->place);
    };
    return keys.kind == KeyKind::integer ? place(keys.integers[index]) : place(keys.texts[index]);
}

std::optional<std::size_t> ReorderBuffer::drop(const KeySpan& keys) {
    for (std::size_t i = 0; i < keys.size(); ++i) {
        if (!place_of(keys, i)) return i;
    }
    for (std::size_t i = 0; i < keys.size(); ++i) {
        if (const auto place = place_of(keys, i)) erase(*place); // the same key may occur again
    }
    return std::nullopt;
}

bool ReorderBuffer::discard(const KeySpan& keys, double time) {
    const auto place = place_of(keys, 0);
    if (!place) return false;
    Line& line = lines_[*place];
    std::uint32_t before = nothing;
    for (std::uint32_t at = line.first; at != nothing; before = at, at = next_[at]) {
        if (times_[at] != time) continue;
        std::uint32_t& link = before == nothing ? line.first : next_[before];
        link = next_[at];
        if (line.last == at) line.last = before;
        free_.push_back(at); // there is room for all
        return true;
    }
    return false;
}

std::vector<std::uint32_t> ReorderBuffer::stale(double before) const {
    std::vector<std::uint32_t> found;
    for (std::uint32_t place = 0; place < size(); ++place) {
        if (lines_[place].newest < before) found.push_back(place);
    }
    return found;
}

// Forgets the key at a place, which the last one takes.
void ReorderBuffer::erase(std::uint32_t place) noexcept {
    for (std::uint32_t at = lines_[place].first; at != nothing; at = next_[at])
        free_.push_back(at);
    keys_.erase(place);
    const std::size_t last = size() - 1;
    lines_[place] = lines_[last];
    lines_.pop_back();
    if (settings_.filled == 0) return;
    std::copy_n(held_.data() + last * inputs(), inputs(), held_.data() + place * inputs());
    held_.resize(last * inputs());
}

std::size_t ReorderBuffer::bytes() const noexcept {
    return keys_.bytes() + lines_.size() * sizeof(Line) +
           (held_.size() + times_.size() + values_.size()) * sizeof(double) +
           (next_.size() + free_.size()) * sizeof(std::uint32_t) +
           origin_.size() * sizeof(std::int64_t);
}

} // namespace rtamt::fleet
