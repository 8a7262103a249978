#include "monitors.hpp"

#include "../program/crc32.hpp"
#include "batch.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <new>
#include <ranges>
#include <stdexcept>
#include <unordered_map>
#include <utility>

namespace rtamt::fleet {

namespace {

constexpr std::string_view magic = "RTAMTFLM";
constexpr std::uint16_t format = 1;
constexpr std::size_t head_size = 16;
constexpr std::size_t checksum_size = 4;

// The version of the states of monitors in this library.
[[nodiscard]] std::uint32_t own_version() {
    const Snapshot empty;
    return Bytes(empty.bytes()).take<std::uint32_t>();
}

} // namespace

// A copy of the monitor at a place, which is to replace it.
struct Monitors::Twin {
    std::uint32_t place;
    Key key;
};

Monitors::Monitors(MonitorProgram program, std::size_t capacity)
    : program_(std::make_unique<MonitorProgram>(std::move(program))), capacity_(capacity),
      values_(program_->inputs.size()), given_(program_->inputs.size()) {
    if (capacity >= Keys::none / 2) throw std::bad_alloc();
    if (program_->version != own_version()) {
        throw std::invalid_argument(
            "This program is for monitors of version " + std::to_string(program_->version) +
            ", and this library has version " + std::to_string(own_version()) +
            ": compile it with the rtamt that has this library.");
    }
    (void)make_monitor(*program_); // which checks the rest of the program
}

// ---- a batch ------------------------------------------------------------------------------------

std::optional<Monitors::Wrong> Monitors::update(const MonitorBatch& batch, const Look& look) {
    if (batch.size() != 0) require_fitting({batch.keys, batch.times, {}}, keys_);
    const std::size_t old_size = size();
    Report report;
    std::vector<Twin> twins;
    std::uint64_t late = 0;
    try {
        if (auto wrong = run(batch, twins, report, late)) {
            forget_from(old_size);
            return wrong;
        }
        look(report);
    } catch (...) {
        forget_from(old_size);
        throw;
    }
    for (Twin& twin : twins)
        monitors_[twin.place] = std::move(twin.key);
    late_ += late;
    return std::nullopt;
}

std::optional<Monitors::Wrong> Monitors::run(const MonitorBatch& batch, std::vector<Twin>& twins,
                                             Report& report, std::uint64_t& late) {
    std::unordered_map<std::uint32_t, std::size_t> twin_at; // by place
    for (std::size_t index = 0; index < batch.size(); ++index) {
        const auto wrong = [&](const char* rest, bool undefined = false) {
            const std::string key = batch.keys.kind == KeyKind::integer
                                        ? std::to_string(batch.keys.integers[index])
                                        : "'" + std::string(batch.keys.texts[index]) + "'";
            return Wrong{index,
                         "Key " + key + " at index " + std::to_string(index) + " of the batch " +
                             rest,
                         undefined};
        };
        auto place = place_of(batch.keys, index);
        if (!place) {
            if (size() == capacity_) {
                const std::string full = "is new, and the fleet has its " +
                                         std::to_string(capacity_) +
                                         " keys already: drop keys, or make a larger fleet.";
                return wrong(full.c_str());
            }
            place = add(batch.keys, index);
        }
        const auto [found, is_new] = twin_at.try_emplace(*place, twins.size());
        if (is_new) twins.push_back({*place, twin_of(*place)});
        Key& key = twins[found->second].key;
        try {
            const AtStart at_start = key.monitor->take(sample_of(batch, index), index, report.rows);
            report.at_start.push_back(at_start);
            if (at_start.late) {
                ++late;
            } else if (!(key.newest >= batch.times[index])) {
                key.newest = batch.times[index];
            }
        } catch (const WrongSample& sample) {
            return wrong(sample.what(), sample.undefined);
        }
    }
    return std::nullopt;
}

std::optional<Monitors::Wrong> Monitors::watermark(double time, const Look& look) {
    Report report;
    std::vector<Key> twins;
    twins.reserve(size());
    for (std::uint32_t place = 0; place < size(); ++place) {
        Key& twin = twins.emplace_back(twin_of(place));
        try {
            report.at_start.push_back(twin.monitor->watermark(time, place, report.rows));
        } catch (const WrongSample& sample) {
            return Wrong{place, "Key " + name_of(place) + " " + sample.what(), sample.undefined};
        }
    }
    look(report);
    monitors_ = std::move(twins);
    return std::nullopt;
}

KeySample Monitors::sample_of(const MonitorBatch& batch, std::size_t index) {
    for (std::size_t input = 0; input < values_.size(); ++input) {
        const double* column = batch.columns[input];
        const std::uint8_t* given = batch.given.empty() ? nullptr : batch.given[input];
        given_[input] = column != nullptr && (given == nullptr || given[index] != 0) ? 1 : 0;
        if (given_[input] == 0) continue;
        const double* uppers = batch.uppers.empty() ? nullptr : batch.uppers[input];
        values_[input] = {column[index], uppers == nullptr ? column[index] : uppers[index]};
    }
    return {batch.times[index], values_, given_};
}

Monitors::Key Monitors::twin_of(std::uint32_t place) const {
    const Key& key = monitors_[place];
    Key twin{make_monitor(*program_), key.newest};
    if (key.monitor != nullptr) twin.monitor->restore(key.monitor->state());
    return twin;
}

// ---- keys ---------------------------------------------------------------------------------------

std::optional<std::uint32_t> Monitors::place_of(const KeySpan& keys, std::size_t index) noexcept {
    if (keys.kind != keys_.kind()) return std::nullopt;
    const auto place = [&](auto key) -> std::optional<std::uint32_t> {
        const Keys::Entry* entry = keys_.find(key, keys_.code(key));
        return entry == nullptr ? std::nullopt : std::optional(entry->place);
    };
    return keys.kind == KeyKind::integer ? place(keys.integers[index]) : place(keys.texts[index]);
}

// Adds a key, whose monitor is still to be made.
std::uint32_t Monitors::add(const KeySpan& keys, std::size_t index) {
    monitors_.emplace_back();
    try {
        if (keys.kind == KeyKind::integer) {
            keys_.add(keys.integers[index], keys_.code(keys.integers[index]));
        } else {
            keys_.add(keys.texts[index], keys_.code(keys.texts[index]));
        }
    } catch (...) {
        monitors_.pop_back();
        throw;
    }
    return static_cast<std::uint32_t>(size() - 1);
}

// Forgets the key at a place, which the last one takes.
void Monitors::erase(std::uint32_t place) noexcept {
    keys_.erase(place);
    if (place != size()) monitors_[place] = std::move(monitors_.back());
    monitors_.pop_back();
}

void Monitors::forget_from(std::size_t old_size) noexcept {
    while (size() > old_size)
        erase(static_cast<std::uint32_t>(size() - 1));
}

std::string Monitors::name_of(std::uint32_t place) const {
    if (keys_.textual()) return "'" + keys_.texts()[place] + "'";
    return std::to_string(std::bit_cast<std::int64_t>(keys_.integers()[place]));
}

std::optional<std::size_t> Monitors::drop(const KeySpan& keys) {
    for (std::size_t i = 0; i < keys.size(); ++i) {
        if (!place_of(keys, i)) return i;
    }
    for (std::size_t i = 0; i < keys.size(); ++i) {
        if (const auto place = place_of(keys, i)) erase(*place); // the same key may come again
    }
    return std::nullopt;
}

std::size_t Monitors::expire(double before) {
    const std::size_t old_size = size();
    for (std::size_t place = old_size; place-- > 0;) {
        if (monitors_[place].newest < before) erase(static_cast<std::uint32_t>(place));
    }
    return old_size - size();
}

// ---- state --------------------------------------------------------------------------------------

std::vector<std::uint8_t> Monitors::snapshot() const {
    StateWriter out;
    out.bytes().assign(magic.begin(), magic.end());
    out.put(format);
    out.put(std::uint16_t{0});
    out.put(program_->version);
    out.put_text(program_->made_of);
    out.put(static_cast<std::int64_t>(capacity_));
    out.put(late_);
    out.put(size() == 0 ? KeyKind::none : keys_.kind());
    out.put_count(size());
    for (std::uint32_t place = 0; place < size(); ++place) {
        if (keys_.textual()) {
            out.put_text(keys_.texts()[place]);
        } else {
            out.put(keys_.integers()[place]);
        }
    }
    out.put_count(size());
    for (const Key& key : monitors_) {
        out.put(key.newest);
        out.put_data(key.monitor->state());
    }
    out.put(crc32(out.bytes()));
    return std::move(out.bytes());
}

Monitors Monitors::restore(MonitorProgram program, std::size_t capacity,
                           std::span<const std::uint8_t> bytes) {
    if (bytes.size() < head_size + checksum_size) refuse("it ends too early");
    const auto body = bytes.first(bytes.size() - checksum_size);
    StateReader state(body);
    for (const char letter : magic) {
        if (state.take<char>() != letter) refuse("it is no state of a monitor for each key");
    }
    if (const auto number = state.take<std::uint16_t>(); number != format) {
        refuse("its format has version " + std::to_string(number) + ", and this is for version " +
               std::to_string(format));
    }
    if (Bytes(bytes.last(checksum_size)).take<std::uint32_t>() != crc32(body)) {
        refuse("its checksum does not match, so it was damaged on the way");
    }
    if (state.take<std::uint16_t>() != 0) refuse("its header has an unknown value");
    const auto version = state.take<std::uint32_t>();
    if (state.take_text() != program.made_of) {
        throw std::invalid_argument(
            "This state is of a fleet with another requirement or other settings: a fleet with a "
            "monitor for each key continues with the same ones.");
    }
    if (version != program.version) {
        throw std::invalid_argument("This state has monitors of version " +
                                    std::to_string(version) + ", and the program has version " +
                                    std::to_string(program.version) +
                                    ": replay the samples that verdicts still depend on.");
    }
    const auto old_capacity = state.take<std::int64_t>();
    const auto late = state.take<std::int64_t>();
    const auto kind = state.take<KeyKind>();
    const std::size_t count = state.take_count();
    if (std::cmp_less(old_capacity, count) || late < 0 || kind > KeyKind::bytes ||
        (kind == KeyKind::none) != (count == 0)) {
        refuse("its header has an unknown value");
    }
    if (capacity == 0) capacity = static_cast<std::size_t>(old_capacity);
    if (capacity < count) {
        throw std::invalid_argument("This state has " + std::to_string(count) +
                                    " keys, more than the capacity of " + std::to_string(capacity) +
                                    ".");
    }
    Monitors fleet(std::move(program), capacity);
    fleet.late_ = static_cast<std::uint64_t>(late);
    fleet.keys_.set_kind(kind);
    const auto add = [&](auto key) {
        const std::uint64_t code = fleet.keys_.code(key);
        if (fleet.keys_.find(key, code) != nullptr) refuse("it has a key twice");
        fleet.keys_.add(key, code);
    };
    for (std::size_t i = 0; i < count; ++i) {
        if (fleet.keys_.textual()) {
            add(state.take_text());
        } else {
            add(state.take<std::int64_t>());
        }
    }
    if (state.take_count() != count) refuse("it does not have a state for each key");
    for (std::size_t i = 0; i < count; ++i) {
        Key& key = fleet.monitors_.emplace_back();
        key.newest = state.take<double>();
        key.monitor = make_monitor(*fleet.program_);
        key.monitor->restore(state.take_data());
    }
    state.end();
    return fleet;
}

} // namespace rtamt::fleet
