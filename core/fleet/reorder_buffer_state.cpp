// Serialisation of the waiting samples of a reorder buffer (docs/reference/fleet-state.md). The
// bytes are untrusted.
#include "reorder_buffer.hpp"
#include "state_bytes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rtamt::fleet {

namespace {

constexpr std::size_t header_size = 40;

} // namespace

std::vector<std::uint8_t> ReorderBuffer::snapshot() const {
    const bool holds = settings_.filled != 0;
    std::size_t size = header_size + key_bytes(keys_);
    for (const std::string& name : names_)
        size += sizeof(std::uint32_t) + name.size();
    size += lines_.size() * (3 + (holds ? inputs() : 0)) * sizeof(double);
    size += waiting() * (1 + inputs()) * sizeof(double);
    std::vector<std::uint8_t> out(size);
    Writer writer(out.data());
    writer.put(static_cast<std::uint8_t>(lines_.empty() ? KeyKind::none : keys_.kind()));
    writer.put(static_cast<std::uint8_t>(holds));
    writer.put(std::uint16_t{0});
    writer.put(static_cast<std::uint32_t>(inputs()));
    writer.put(watermark_);
    writer.put(std::uint64_t{late_});
    writer.put(std::uint64_t{lines_.size()});
    writer.put(std::uint64_t{waiting()});
    for (const std::string& name : names_)
        writer.put_text(name);
    put_keys(keys_, writer);
    for (std::size_t place = 0; place < lines_.size(); ++place) {
        const Line& line = lines_[place];
        writer.put(line.newest);
        writer.put(line.left);
        if (holds) writer.put(held_.data() + place * inputs(), inputs() * sizeof(double));
        std::uint64_t count = 0;
        for (std::uint32_t at = line.first; at != nothing; at = next_[at])
            ++count;
        writer.put(count);
        for (std::uint32_t at = line.first; at != nothing; at = next_[at]) {
            writer.put(times_[at]);
            writer.put(values_.data() + at * inputs(), inputs() * sizeof(double));
        }
    }
    return out;
}

ReorderBuffer ReorderBuffer::restore(std::vector<std::string> names, const Settings& settings,
                                     std::span<const std::uint8_t> bytes) {
    ReorderBuffer made(std::move(names), settings);
    Bytes rest(bytes);
    const auto kind = rest.take<std::uint8_t>();
    const auto holds = rest.take<std::uint8_t>();
    const auto reserved = rest.take<std::uint16_t>();
    if (kind > 3 || holds > 1 || reserved != 0) refuse("what waits has an unknown value");
    const auto inputs = rest.take<std::uint32_t>();
    made.watermark_ = rest.take<double>();
    made.late_ = rest.take<std::uint64_t>();
    const auto keys = rest.take<std::uint64_t>();
    const auto waiting = rest.take<std::uint64_t>();
    if (std::isnan(made.watermark_)) refuse("its watermark is no time");
    if (keys > settings.capacity || keys > rest.left() || inputs > rest.left() ||
        waiting > rest.left() / sizeof(double) || (kind == 0 && keys != 0)) {
        refuse("what waits promises more than there is");
    }
    std::vector<std::string_view> stored;
    stored.reserve(inputs);
    for (std::uint32_t input = 0; input < inputs; ++input)
        stored.push_back(rest.take_text());
    std::vector<std::size_t> from; // where each input is among those of the state
    for (const std::string& name : made.names_) {
        const auto found = std::ranges::find(stored, name);
        if (found == stored.end() && waiting != 0) {
            throw std::invalid_argument(
                "The state has samples that wait for earlier ones, without '" +
                name.substr(0, name.find('\0')) +
                "', which the specification reads: release them with watermark() before the "
                "specification changes.");
        }
        from.push_back(static_cast<std::size_t>(found - stored.begin()));
    }
    take_keys(made.keys_, static_cast<KeyKind>(kind), keys, rest);
    made.lines_.resize(static_cast<std::size_t>(keys));
    const bool fills = settings.filled != 0;
    if (fills) {
        made.held_.assign(made.lines_.size() * made.inputs(),
                          std::numeric_limits<double>::quiet_NaN());
    }
    std::vector<double> values(inputs);
    const auto take_values = [&] {
        for (double& value : values)
            value = rest.take<double>();
    };
    for (std::size_t place = 0; place < made.lines_.size(); ++place) {
        Line& line = made.lines_[place];
        line.newest = rest.take<double>();
        line.left = rest.take<double>();
        const auto is_time = [](double time) { return std::isfinite(time) || time == never; };
        if (!is_time(line.newest) || !is_time(line.left) || line.left > line.newest) {
            refuse("a key has an impossible time");
        }
        if (holds != 0) take_values();
        for (std::size_t input = 0; holds != 0 && fills && input < from.size(); ++input) {
            if (from[input] < values.size()) {
                made.held_[place * from.size() + input] = values[from[input]];
            }
        }
        const auto count = rest.take<std::uint64_t>();
        // Without any that wait, inputs may be absent.
        if (count > waiting - made.waiting()) refuse("what waits is too long");
        double before = line.left;
        for (std::uint64_t i = 0; i < count; ++i) {
            const auto time = rest.take<double>();
            take_values();
            const auto undefined = [](double value) { return std::isnan(value); };
            if (!std::isfinite(time) || !(time > before) || time > line.newest ||
                std::ranges::any_of(values, undefined)) {
                refuse("a sample that waits is impossible");
            }
            before = time;
            const std::uint32_t at = made.make_room();
            made.times_[at] = time;
            for (std::size_t input = 0; input < from.size(); ++input)
                made.values_[at * from.size() + input] = values[from[input]];
            (line.last == nothing ? line.first : made.next_[line.last]) = at;
            made.next_[at] = nothing;
            line.last = at;
        }
    }
    if (rest.left() != 0 || made.waiting() != waiting) refuse("what waits is too long");
    made.added_.clear();
    return made;
}

} // namespace rtamt::fleet
