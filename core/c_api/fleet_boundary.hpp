// Shared parts of the C API of fleets and streams: handles, keys, and error messages.
#pragma once

#include "../fleet/monitor_program.hpp"
#include "../fleet/stream.hpp"

#include "../program/metadata.hpp"
#include "../values/ticks.hpp"
#include "boundary.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rtamt::c_api {

// A batch was rejected at this sample.
struct RejectedBatch : std::invalid_argument {
    RejectedBatch(const std::string& sentence, const fleet::Rejected& why)
        : std::invalid_argument(sentence), rejected(why) {}
    fleet::Rejected rejected;
};

[[nodiscard]] inline std::string shown(double number) {
    char text[32];
    (void)std::snprintf(text, sizeof text, "%.15g", number);
    return text;
}

[[nodiscard]] inline std::string name_of(const fleet::KeySpan& keys, std::size_t index) {
    if (keys.kind == fleet::KeyKind::integer) return std::to_string(keys.integers[index]);
    return "'" + std::string(keys.texts[index]) + "'";
}

[[nodiscard]] inline std::string at_index(std::size_t index) {
    return " at index " + std::to_string(index) + " of the batch ";
}

// The first value of a batch in place of a Boolean that is neither 1 nor 0. NaN is left to the
// fleet.
[[nodiscard]] inline std::optional<fleet::Rejected> wrong_truth(const Metadata& metadata,
                                                                const fleet::Batch& batch) {
    std::optional<fleet::Rejected> wrong;
    std::size_t count = batch.size();
    for (const std::uint32_t input : metadata.booleans) {
        for (std::size_t i = 0; i < count; ++i) {
            const double value = batch.columns[input][i];
            if (value == 0.0 || value == 1.0 || std::isnan(value)) continue;
            wrong = fleet::Rejected{i, fleet::Rejected::Reason::value, 0, {}, input};
            count = i;
        }
    }
    return wrong;
}

// Throws for such a value, and puts its index in the batch into `rejected`.
inline void require_truths(const Metadata& metadata, const fleet::Batch& batch,
                           std::size_t* rejected) {
    const auto wrong = wrong_truth(metadata, batch);
    if (!wrong) return;
    const std::size_t index = wrong->index;
    put(rejected, index);
    throw RejectedBatch("Key " + name_of(batch.keys, index) + at_index(index) + "has " +
                            shown(batch.columns[wrong->instruction][index]) + " as '" +
                            metadata.inputs[wrong->instruction] + "' at " +
                            shown(batch.times[index]) + " s, which is Boolean: give 0 or 1.",
                        *wrong);
}

// Throws for the first finite time that is none in seconds, and puts its index in the batch into
// `rejected`; others are left to the fleet.
inline void require_seconds(const fleet::Batch& batch, std::size_t* rejected) {
    for (std::size_t i = 0; i < batch.size(); ++i) {
        const double time = batch.times[i];
        if (!std::isfinite(time) || std::fabs(time) < ticks::implausible) continue;
        put(rejected, i);
        throw RejectedBatch(
            "Key " + name_of(batch.keys, i) + at_index(i) + "has the time " + shown(time) +
                " s, which is no time in seconds: divide it, if it is in another unit.",
            {.index = i, .reason = fleet::Rejected::Reason::time});
    }
}

// Whether a text is UTF-8, as Python decodes it.
[[nodiscard]] inline bool is_utf8(std::string_view text) noexcept {
    constexpr std::array<std::uint32_t, 4> least{0, 0x80, 0x800, 0x10000}; // by number of bytes
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    for (std::size_t i = 0; i < text.size();) {
        const std::uint32_t first = byte(i++);
        if (first < 0x80U) continue;
        const std::size_t more = first >= 0xF0U ? 3 : first >= 0xE0U ? 2 : 1;
        if (first < 0xC0U || first >= 0xF8U || text.size() - i < more) return false;
        std::uint32_t code = first & (0x3FU >> more);
        for (const std::size_t end = i + more; i < end; ++i) {
            if ((byte(i) & 0xC0U) != 0x80U) return false;
            code = code << 6U | (byte(i) & 0x3FU);
        }
        const bool surrogate = code >= 0xD800U && code < 0xE000U;
        if (code < least.at(more) || code > 0x10FFFFU || surrogate) return false;
    }
    return true;
}

// Throws for the first text that is not UTF-8, as those of a state have to be, and puts its index
// in the batch into `rejected`.
inline void require_texts(const fleet::KeySpan& keys, std::size_t* rejected) {
    if (keys.kind != fleet::KeyKind::text) return;
    const auto wrong = std::ranges::find_if_not(keys.texts, is_utf8);
    if (wrong == keys.texts.end()) return;
    const auto index = static_cast<std::size_t>(wrong - keys.texts.begin());
    put(rejected, index);
    throw std::invalid_argument("The key at index " + std::to_string(index) +
                                " of the batch is not UTF-8: encode it, or use whole numbers.");
}

// `place`: of the sample in the batch, or that it waited.
[[nodiscard]] inline std::string sentence_of(const Metadata& metadata,
                                             const fleet::Fleet::Settings& settings,
                                             const fleet::Batch& batch, const fleet::Rejected& why,
                                             const std::string& place) {
    const std::string where = "Key " + name_of(batch.keys, why.index) + place;
    const std::string time = shown(batch.times[why.index]) + " s";
    switch (why.reason) {
    case fleet::Rejected::Reason::full:
        return where + "is new, and the fleet has its " + std::to_string(settings.capacity) +
               " keys already: drop keys, or make a larger fleet.";
    case fleet::Rejected::Reason::value:
        return where + "has NaN as '" + metadata.inputs[why.instruction] + "' at " + time +
               ": leave the sample out.";
    case fleet::Rejected::Reason::gap:
        if (why.time) { // no value is held for so long
            return where + "has a sample at " + time + ", and more than " +
                   std::to_string(fleet::Stream::longest_hold) + " are missing after the one at " +
                   shown(*why.last) + " s: drop the key, so that its trace begins again.";
        }
        return where + "has a sample at " + time + ", which is not one period of " +
               shown(settings.period) + " s after the one at " + shown(*why.last) + " s.";
    case fleet::Rejected::Reason::undefined: {
        const auto found = metadata.meanings.find(why.instruction);
        const std::string what = found != metadata.meanings.end()
                                     ? "'" + found->second + "'"
                                     : "instruction " + std::to_string(why.instruction);
        return where + "has no value of " + what + " at sample " + std::to_string(why.samples) +
               (why.time ? ", time " + shown(*why.time) + " s" : "") +
               ": it is 0/0, inf - inf, 0 * inf, or a function outside its domain.";
    }
    case fleet::Rejected::Reason::time:
        break;
    }
    if (!why.last || !std::isfinite(batch.times[why.index])) {
        return where + "has the time " + time + ": give a finite number of seconds.";
    }
    return where + "has a sample at " + time + ", which is not after the one at " +
           shown(*why.last) + " s.";
}

// `Handle` has a `message`, and `shown`, which is it or a sentence that needs no memory.
template <class Handle, class Work>
[[nodiscard]] rtamt_status error_boundary(Handle* handle, Work&& work) noexcept {
    if (handle == nullptr) return RTAMT_REFUSED;
    bool undefined = false;
    const auto remember = [&](const char* sentence) noexcept {
        try {
            handle->message = sentence;
            handle->shown = handle->message.c_str();
        } catch (const std::bad_alloc&) {
            handle->shown = out_of_memory;
        }
    };
    const rtamt_status status = guarded(
        [&] {
            try {
                std::forward<Work>(work)(*handle);
            } catch (const RejectedBatch& rejected) {
                undefined = rejected.rejected.reason == fleet::Rejected::Reason::undefined;
                throw;
            }
        },
        remember);
    return undefined && status == RTAMT_REFUSED ? RTAMT_UNDEFINED : status;
}

[[nodiscard]] inline fleet::KeySpan span_of(const int64_t* keys, std::size_t count) {
    return {fleet::KeyKind::integer, items(keys, count, "The keys"), {}};
}

// The texts are in `held`; they are bytes where the keys that are there are, as in a state of
// Python.
[[nodiscard]] inline fleet::KeySpan span_of(const char* const* keys, std::size_t count,
                                            const fleet::Keys& there,
                                            std::vector<std::string_view>& held) {
    for (const char* key : items(keys, count, "The keys")) {
        if (key == nullptr) throw std::invalid_argument("A key is null: pass a text.");
        held.emplace_back(key);
    }
    const bool binary = there.size() != 0 && there.kind() == fleet::KeyKind::bytes;
    return {binary ? fleet::KeyKind::bytes : fleet::KeyKind::text, {}, held};
}

// The settings of a fleet; a gap is rejected.
[[nodiscard]] inline fleet::Fleet::Settings
settings_of(const Metadata& metadata, std::size_t capacity, double tolerance, const char* mend) {
    if (!metadata.early.empty()) {
        throw std::invalid_argument(std::string("This program of bounds is for one monitor: ") +
                                    mend);
    }
    if (!(tolerance >= 0.0)) {
        throw std::invalid_argument("The tolerance must be 0 or more.");
    }
    return {metadata.seconds(), tolerance, false, capacity};
}

// A program of discrete time. `mend`: the rest of the sentence about another one.
[[nodiscard]] inline Program parsed_of(std::span<const std::uint8_t> program, const char* mend) {
    if (fleet::MonitorProgram::begins(program)) {
        throw std::invalid_argument(
            std::string("This program has a monitor for each key, which fleets run: ") + mend);
    }
    constexpr std::size_t place = 10; // of the time domain
    if (program.size() > place && program[place] == 1) {
        (void)Program::parse(program, Domain::dense);
        throw std::invalid_argument(std::string("This program of dense time is for one monitor: ") +
                                    mend);
    }
    return Program::parse(program);
}

// A handle of what `make` makes of a program, the names of its inputs and its settings. `mend`: how
// to have a program for it.
template <class Handle, class Make>
[[nodiscard]] rtamt_status create(const void* program, std::size_t size, std::size_t capacity,
                                  double tolerance, Handle** handle, char* message,
                                  std::size_t room, const char* mend, const Make& make) {
    const auto say = [&](const char* sentence) { copy_message(sentence, message, room); };
    if (handle == nullptr) {
        say(no_place);
        return RTAMT_REFUSED;
    }
    *handle = nullptr;
    return guarded(
        [&] {
            Program parsed = parsed_of(bytes(program, size), mend);
            Metadata metadata = Metadata::parse(parsed);
            const fleet::Fleet::Settings settings =
                settings_of(metadata, capacity, tolerance, mend);
            auto made = make(std::move(parsed), metadata.inputs, settings);
            *handle = new Handle{std::move(metadata), std::move(made)};
        },
        say);
}

// Drops keys of a fleet or a stream.
template <class Keyed>
void drop(Keyed& keyed, const fleet::KeySpan& keys) {
    if (const auto missing = keyed.drop(keys)) {
        throw std::invalid_argument("There is no key " + name_of(keys, *missing) + ".");
    }
}

} // namespace rtamt::c_api
