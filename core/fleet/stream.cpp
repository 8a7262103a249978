#include "stream.hpp"

#include "../program/crc32.hpp"
#include "state_bytes.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace rtamt::fleet {

namespace {

constexpr std::string_view magic = "RTAMTFLE";
constexpr std::uint16_t version = 1;
constexpr std::size_t head_size = 32;
constexpr std::size_t checksum_size = 4;

// Adds a key of a span, or of the keys of a buffer.
void add_key(Stream::Released& released, const KeySpan& keys, std::size_t index) {
    if (keys.kind == KeyKind::integer) {
        released.integers.push_back(keys.integers[index]);
    } else {
        released.texts.emplace_back(keys.texts[index]);
    }
}
void add_key(Stream::Released& released, const Keys& keys, std::size_t place) {
    if (keys.textual()) {
        released.texts.push_back(keys.texts()[place]);
    } else {
        released.integers.push_back(std::bit_cast<std::int64_t>(keys.integers()[place]));
    }
}

// Why a batch was rejected because of a sample of the one key of `one`.
[[nodiscard]] Stream::Failure failure_of(const Rejected& why, bool waited,
                                         const Stream::Released& one, double time) {
    return {why, waited, one.integers.empty() ? 0 : one.integers.front(),
            one.texts.empty() ? std::string() : one.texts.front(), time};
}

} // namespace

Stream::Stream(Fleet fleet, std::vector<std::string> names, double lateness, Gaps gaps)
    : fleet_(std::move(fleet)), lateness_(lateness), gaps_(gaps),
      buffer_(std::move(names), settings_of(fleet_.settings(), lateness, gaps)) {}

std::optional<Stream::Failure> Stream::take(const Batch& batch, std::uint8_t* late) {
    if (const auto wrong = buffer_.offer(batch, late)) {
        Released one;
        add_key(one, batch.keys, wrong->index);
        const double time = batch.times[wrong->index];
        const double gap_to = wrong->time.value_or(time); // else a sample that waited
        const bool waited = wrong->reason == Rejected::Reason::gap && gap_to != time;
        return failure_of(*wrong, waited, one, gap_to);
    }
    return monitor(&batch.keys);
}

std::optional<Stream::Failure> Stream::advance(double watermark) {
    if (const auto wrong = buffer_.advance(watermark)) {
        Released one;
        add_key(one, buffer_.keys(), wrong->index);
        return failure_of(*wrong, true, one, wrong->time.value_or(0.0));
    }
    return monitor(nullptr);
}

KeySpan Stream::keys_of(const Released& released, std::vector<std::string_view>& held) {
    if (released.kind == KeyKind::integer) return {released.kind, released.integers, {}};
    held.assign(released.texts.begin(), released.texts.end());
    return {released.kind, {}, held};
}

// Has the fleet monitor what has left; `keys`: of the batch, null where there is none.
std::optional<Stream::Failure> Stream::monitor(const KeySpan* keys) {
    try {
        const ReorderBuffer::Ready& ready = buffer_.ready();
        const std::size_t count = ready.size();
        Released made;
        made.kind = keys != nullptr ? keys->kind : buffer_.keys().kind();
        for (const std::int64_t place : ready.places) {
            const auto at = static_cast<std::size_t>(place);
            keys != nullptr ? add_key(made, *keys, at) : add_key(made, buffer_.keys(), at);
        }
        made.times = ready.times;
        const std::size_t outputs = fleet_.program().outputs.size();
        made.values.resize(count * outputs);
        made.when.resize(count * outputs);
        made.known.resize(count * outputs);
        made.warming.resize(count * outputs);
        if (count != 0) {
            std::vector<std::string_view> held;
            std::vector<const double*> columns;
            columns.reserve(ready.columns.size());
            for (const auto& column : ready.columns)
                columns.push_back(column.data());
            std::vector<Output> places;
            places.reserve(outputs);
            for (std::size_t k = 0; k < outputs; ++k) {
                places.push_back({made.values.data() + k * count, made.known.data() + k * count,
                                  made.when.data() + k * count, made.warming.data() + k * count});
            }
            const Batch batch{keys_of(made, held), made.times.data(), columns};
            if (auto wrong = fleet_.update(batch, places)) {
                const std::size_t at = ready.sample_of(wrong->index);
                Failure failure{
                    *wrong, ready.own[at] == 0, made.integers.empty() ? 0 : made.integers[at],
                    made.texts.empty() ? std::string() : made.texts[at], made.times[at]};
                if (!failure.waited) failure.why.index = static_cast<std::size_t>(ready.places[at]);
                buffer_.withdraw();
                return failure;
            }
        }
        released_ = std::move(made);
    } catch (...) {
        buffer_.withdraw();
        throw;
    }
    buffer_.accept();
    return std::nullopt;
}

std::optional<std::size_t> Stream::drop(const KeySpan& keys) {
    std::vector<std::size_t> monitored;
    for (std::size_t i = 0; i < keys.size(); ++i) {
        const auto place = buffer_.place_of(keys, i);
        if (!place) return i;
        if (buffer_.has_left(*place)) monitored.push_back(i);
    }
    KeySpan some{keys.kind, {}, {}};
    std::vector<std::int64_t> integers;
    std::vector<std::string_view> texts;
    for (const std::size_t i : monitored) {
        if (keys.kind == KeyKind::integer) {
            integers.push_back(keys.integers[i]);
        } else {
            texts.push_back(keys.texts[i]);
        }
    }
    some.integers = integers;
    some.texts = texts;
    (void)buffer_.drop(keys);
    if (!monitored.empty()) (void)fleet_.drop(some);
    return std::nullopt;
}

std::size_t Stream::expire(double before) {
    Released stale;
    stale.kind = buffer_.keys().kind();
    for (const std::uint32_t place : buffer_.stale(before))
        add_key(stale, buffer_.keys(), place);
    std::vector<std::string_view> held;
    const KeySpan keys = keys_of(stale, held);
    const std::size_t count = stale.integers.size() + stale.texts.size();
    if (count != 0) (void)drop(keys);
    return count;
}

// ---- state --------------------------------------------------------------------------------------

std::vector<std::uint8_t> Stream::snapshot() const {
    const std::vector<std::uint8_t> waiting = buffer_.snapshot();
    std::vector<std::uint8_t> bytes(head_size + waiting.size() + fleet_.snapshot_size() +
                                    checksum_size);
    Writer writer(bytes.data());
    writer.put(magic.data(), magic.size());
    writer.put(version);
    writer.put(static_cast<std::uint8_t>(gaps_));
    writer.put(std::uint8_t{1});
    writer.put(std::uint32_t{0});
    writer.put(lateness_);
    writer.put(std::uint64_t{waiting.size()});
    writer.put(waiting.data(), waiting.size());
    const std::span<std::uint8_t> all(bytes);
    fleet_.snapshot(all.subspan(head_size + waiting.size(), fleet_.snapshot_size()));
    const std::uint32_t sum = crc32(all.first(all.size() - checksum_size));
    Writer(bytes.data() + bytes.size() - checksum_size).put(sum);
    return bytes;
}

Stream Stream::restore(Program program, const std::vector<std::string>& names,
                       Fleet::Settings settings, std::span<const std::uint8_t> bytes) {
    if (bytes.size() < head_size + checksum_size) refuse("it ends too early");
    const auto body = bytes.first(bytes.size() - checksum_size);
    Bytes rest(body);
    const auto found = rest.take(magic.size());
    if (!std::equal(found.begin(), found.end(), magic.begin())) {
        refuse("it is no state of a fleet with lateness");
    }
    if (const auto number = rest.take<std::uint16_t>(); number != version) {
        refuse("its format has version " + std::to_string(number) + ", and this is for version " +
               std::to_string(version));
    }
    if (Bytes(bytes.last(checksum_size)).take<std::uint32_t>() != crc32(body)) {
        refuse("its checksum does not match, so it was damaged on the way");
    }
    const auto gaps = rest.take<std::uint8_t>();
    const auto buffered = rest.take<std::uint8_t>();
    const auto reserved = rest.take<std::uint32_t>();
    const auto lateness = rest.take<double>();
    const auto length = rest.take<std::uint64_t>();
    if (gaps > static_cast<std::uint8_t>(Gaps::hold) || buffered > 1 || reserved != 0) {
        refuse("its header has an unknown value");
    }
    if (buffered == 0 || !(lateness >= 0.0) || !std::isfinite(lateness)) {
        refuse("it is no state of a fleet with lateness");
    }
    const auto waiting = rest.take(length);
    settings.restart = gaps == static_cast<std::uint8_t>(Gaps::restart);
    Fleet fleet = Fleet::restore(std::move(program), names, settings, rest.take(rest.left()));
    const auto chosen = static_cast<Gaps>(gaps);
    ReorderBuffer buffer =
        ReorderBuffer::restore(names, settings_of(fleet.settings(), lateness, chosen), waiting);
    Stream made(std::move(fleet), lateness, chosen, std::move(buffer));
    std::size_t left = 0;
    const Keys& keys = made.buffer_.keys();
    for (std::uint32_t place = 0; place < made.size(); ++place) {
        if (!made.buffer_.has_left(place)) continue;
        Released one;
        one.kind = keys.kind();
        add_key(one, keys, place);
        std::vector<std::string_view> held;
        if (!made.fleet_.contains(made.keys_of(one, held), 0))
            refuse("what waits is of other keys");
        ++left;
    }
    if (left != made.fleet_.size()) refuse("what waits is of other keys");
    return made;
}

} // namespace rtamt::fleet
