// Shared parts of the C API of fleets and streams: handles, keys, and error messages.
#pragma once

#include "../fleet/fleet.hpp"

#include "../program/metadata.hpp"
#include "boundary.hpp"

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
        return where + "has a sample at " + time + ", which is not one period of " +
               shown(settings.period) + " s after the one at " + shown(*why.last) + " s.";
    case fleet::Rejected::Reason::undefined: {
        const auto found = metadata.meanings.find(why.instruction);
        const std::string what = found != metadata.meanings.end()
                                     ? "'" + found->second + "'"
                                     : "instruction " + std::to_string(why.instruction);
        return where + "has no value of " + what + " at sample " + std::to_string(why.samples) +
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

// The texts are in `held`.
[[nodiscard]] inline fleet::KeySpan span_of(const char* const* keys, std::size_t count,
                                            std::vector<std::string_view>& held) {
    for (const char* key : items(keys, count, "The keys")) {
        if (key == nullptr) throw std::invalid_argument("A key is null: pass a text.");
        held.emplace_back(key);
    }
    return {fleet::KeyKind::text, {}, held};
}

// The settings of a fleet; a gap is rejected.
[[nodiscard]] inline fleet::Fleet::Settings settings_of(const Metadata& metadata,
                                                        std::size_t capacity, double tolerance) {
    if (!metadata.early.empty()) {
        throw std::invalid_argument("This program of bounds is for one monitor: compile it for a "
                                    "fleet, with rtamt compile --fleet.");
    }
    if (!(tolerance >= 0.0)) {
        throw std::invalid_argument("The tolerance must be 0 or more.");
    }
    return {metadata.seconds(), tolerance, false, capacity};
}

// A program of discrete time.
[[nodiscard]] inline Program parsed_of(std::span<const std::uint8_t> program) {
    constexpr std::size_t place = 10; // of the time domain
    if (program.size() > place && program[place] == 1) {
        (void)Program::parse(program, Domain::dense);
        throw std::invalid_argument("This program of dense time is for one monitor: compile it for "
                                    "a fleet, with rtamt compile --fleet.");
    }
    return Program::parse(program);
}

// A handle of what `make` makes of a program, the names of its inputs and its settings.
template <class Handle, class Make>
[[nodiscard]] rtamt_status create(const void* program, std::size_t size, std::size_t capacity,
                                  double tolerance, Handle** handle, char* message,
                                  std::size_t room, const Make& make) {
    const auto say = [&](const char* sentence) { copy_message(sentence, message, room); };
    if (handle == nullptr) {
        say(no_place);
        return RTAMT_REFUSED;
    }
    *handle = nullptr;
    return guarded(
        [&] {
            Program parsed = parsed_of(bytes(program, size));
            Metadata metadata = Metadata::parse(parsed);
            const fleet::Fleet::Settings settings = settings_of(metadata, capacity, tolerance);
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
