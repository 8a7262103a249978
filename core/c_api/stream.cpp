// The C API of streams: fleets whose samples come in any order.
#include "fleet_boundary.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>
#include <vector>

using namespace rtamt::c_api;
using rtamt::Metadata;
using rtamt::Program;
using rtamt::fleet::Batch;
using rtamt::fleet::Fleet;
using rtamt::fleet::KeyKind;
using rtamt::fleet::KeySpan;
using rtamt::fleet::Rejected;
using rtamt::fleet::Stream;

struct rtamt_stream {
    rtamt_stream(Metadata&& of, Stream&& made) : metadata(std::move(of)), stream(std::move(made)) {}

    Metadata metadata;
    Stream stream;
    std::string message;
    const char* shown = ""; // the message, or a sentence that needs no memory
    std::vector<std::uint8_t> late;
    std::optional<Stream::Failure> culprit; // that waited
};

namespace {

constexpr const char* compiled_for_streams =
    "a stream has delayed verdicts in discrete time, so compile it without --verdict and --time.";

// Raises the error for a failure; `batch`: null where there was none.
[[noreturn]] void fail(rtamt_stream& handle, const Batch* batch, Stream::Failure failure,
                       std::size_t* rejected) {
    const Fleet::Settings& settings = handle.stream.fleet().settings();
    Rejected why = failure.why;
    if (!failure.waited && batch != nullptr) {
        put(rejected, why.index);
        throw RejectedBatch(
            sentence_of(handle.metadata, settings, *batch, why, at_index(why.index)), why);
    }
    // The sample alone is the batch of the sentence.
    const std::int64_t integer = failure.key;
    const std::string_view text = failure.text;
    const bool numbered = handle.stream.integers();
    const KeySpan key = numbered ? KeySpan{KeyKind::integer, {&integer, 1}, {}}
                                 : KeySpan{KeyKind::text, {}, {&text, 1}};
    const Batch one{key, &failure.time, {}};
    why.index = 0;
    const std::string sentence =
        sentence_of(handle.metadata, settings, one, why, ", a sample that waited, ");
    handle.culprit = std::move(failure);
    throw RejectedBatch(sentence, why);
}

// What is reported of a call that fails before it looks at its batch.
void begin(rtamt_stream& handle, std::size_t count, std::size_t* released,
           std::size_t* rejected) noexcept {
    put(rejected, count);
    put(released, std::size_t{0});
    handle.culprit.reset();
}

void update(rtamt_stream& handle, const KeySpan& keys, const double* times,
            const double* const* columns, std::int32_t* late, std::size_t* released,
            std::size_t* rejected) {
    const std::size_t count = keys.size();
    Batch batch{
        keys, items(times, count, "The times").data(),
        items(columns, count == 0 ? 0 : handle.stream.fleet().program().inputs, "The columns")};
    for (const double* column : batch.columns)
        (void)items(column, count, "The values of a column");
    require_texts(keys, rejected);
    require_seconds(batch, rejected);
    require_truths(handle.metadata, batch, rejected);
    handle.late.assign(count, 0);
    if (auto failure = handle.stream.take(batch, handle.late.data())) {
        fail(handle, &batch, std::move(*failure), rejected);
    }
    for (std::size_t i = 0; late != nullptr && i < count; ++i)
        late[i] = handle.late[i];
    put(released, handle.stream.released().size());
}

void discard(rtamt_stream& handle, const KeySpan& key, double time) {
    if (!handle.stream.discard(key, time)) {
        throw std::invalid_argument("No sample of the key " + name_of(key, 0) + " waits at " +
                                    shown(time) + " s.");
    }
}

[[nodiscard]] rtamt_stream_sample sample_of(std::int64_t key, const char* text, double time) {
    return {key, text, time};
}

} // namespace

extern "C" {

rtamt_status rtamt_stream_create(const void* program, size_t size, size_t capacity,
                                 double tolerance, double lateness, rtamt_gaps gaps,
                                 rtamt_stream** stream, char* message, size_t room) {
    return create(program, size, capacity, tolerance, stream, message, room, compiled_for_streams,
                  [&](Program&& parsed, const auto& names, Fleet::Settings settings) {
                      if (!(lateness >= 0.0) || !std::isfinite(lateness)) {
                          throw std::invalid_argument(
                              "The lateness must be a number of seconds, 0 or more.");
                      }
                      // As a number, because other values than those of the type may be passed.
                      std::uint32_t policy = 0;
                      static_assert(sizeof policy == sizeof gaps);
                      std::memcpy(&policy, &gaps, sizeof policy);
                      if (policy > static_cast<std::uint32_t>(RTAMT_GAPS_HOLD)) {
                          throw std::invalid_argument("There is no such policy for gaps.");
                      }
                      settings.restart = gaps == RTAMT_GAPS_RESTART;
                      return Stream(Fleet(std::move(parsed), names, settings), names, lateness,
                                    static_cast<Stream::Gaps>(gaps));
                  });
}

rtamt_status rtamt_stream_restore(const void* program, size_t size, const void* state,
                                  size_t state_size, size_t capacity, double tolerance,
                                  rtamt_stream** stream, char* message, size_t room) {
    return create(program, size, capacity, tolerance, stream, message, room, compiled_for_streams,
                  [&](Program&& parsed, const auto& names, const Fleet::Settings& settings) {
                      return Stream::restore(std::move(parsed), names, settings,
                                             bytes(state, state_size));
                  });
}

void rtamt_stream_destroy(rtamt_stream* stream) { // NOLINT(misc-const-correctness): the C API
    delete stream;
}

const char* rtamt_stream_message(const rtamt_stream* stream) {
    return stream == nullptr ? "There is no stream: it was not created." : stream->shown;
}

rtamt_status rtamt_stream_update(rtamt_stream* stream, const int64_t* keys, const double* times,
                                 const double* const* columns, size_t count, int32_t* late,
                                 size_t* released, size_t* rejected) {
    return error_boundary(stream, [&](rtamt_stream& self) {
        begin(self, count, released, rejected);
        update(self, span_of(keys, count), times, columns, late, released, rejected);
    });
}

rtamt_status rtamt_stream_update_text(rtamt_stream* stream, const char* const* keys,
                                      const double* times, const double* const* columns,
                                      size_t count, int32_t* late, size_t* released,
                                      size_t* rejected) {
    return error_boundary(stream, [&](rtamt_stream& self) {
        begin(self, count, released, rejected);
        std::vector<std::string_view> held;
        update(self, span_of(keys, count, self.stream.keys(), held), times, columns, late, released,
               rejected);
    });
}

rtamt_status rtamt_stream_watermark(rtamt_stream* stream, double time, size_t* released) {
    return error_boundary(stream, [&](rtamt_stream& self) {
        begin(self, 0, released, nullptr);
        if (std::isnan(time)) throw std::invalid_argument("The watermark is NaN: give a time.");
        if (auto failure = self.stream.advance(time)) {
            fail(self, nullptr, std::move(*failure), nullptr);
        }
        put(released, self.stream.released().size());
    });
}

rtamt_status rtamt_stream_released(rtamt_stream* stream, size_t index, rtamt_stream_sample* sample,
                                   rtamt_fleet_value* results, size_t outputs) {
    return error_boundary(stream, [&](rtamt_stream& self) {
        const Stream::Released& released = self.stream.released();
        const std::size_t count = released.size();
        const std::size_t all = self.stream.fleet().program().outputs.size();
        if (index >= count) {
            throw std::invalid_argument(std::to_string(count) + " samples have left, so that " +
                                        std::to_string(index) + " is no index of one.");
        }
        if (outputs > all) {
            throw std::invalid_argument("The program has " + std::to_string(all) +
                                        " outputs, not " + std::to_string(outputs) + ".");
        }
        (void)items(results, outputs, "The places for the results");
        const bool numbered = released.kind == KeyKind::integer;
        put(sample,
            sample_of(numbered ? released.integers[index] : 0,
                      numbered ? nullptr : released.texts[index].c_str(), released.times[index]));
        for (std::size_t k = 0; k < outputs; ++k) {
            const std::size_t at = k * count + index;
            results[k] = {released.values[at], released.when[at], released.known[at],
                          released.warming[at]};
        }
    });
}

rtamt_status rtamt_stream_culprit(rtamt_stream* stream, rtamt_stream_sample* sample) {
    return error_boundary(stream, [&](rtamt_stream& self) {
        if (!self.culprit) {
            throw std::invalid_argument("The last call did not fail because of a sample that "
                                        "waited.");
        }
        const Stream::Failure& culprit = *self.culprit;
        put(sample, sample_of(culprit.key, self.stream.integers() ? nullptr : culprit.text.c_str(),
                              culprit.time));
    });
}

rtamt_status rtamt_stream_discard(rtamt_stream* stream, int64_t key, double time) {
    return error_boundary(stream,
                          [&](rtamt_stream& self) { discard(self, span_of(&key, 1), time); });
}

rtamt_status rtamt_stream_discard_text(rtamt_stream* stream, const char* key, double time) {
    return error_boundary(stream, [&](rtamt_stream& self) {
        std::vector<std::string_view> held;
        discard(self, span_of(&key, 1, self.stream.keys(), held), time);
    });
}

rtamt_status rtamt_stream_drop(rtamt_stream* stream, const int64_t* keys, size_t count) {
    return error_boundary(stream,
                          [&](rtamt_stream& self) { drop(self.stream, span_of(keys, count)); });
}

rtamt_status rtamt_stream_drop_text(rtamt_stream* stream, const char* const* keys, size_t count) {
    return error_boundary(stream, [&](rtamt_stream& self) {
        std::vector<std::string_view> held;
        drop(self.stream, span_of(keys, count, self.stream.keys(), held));
    });
}

rtamt_status rtamt_stream_expire(rtamt_stream* stream, double before, size_t* dropped) {
    return error_boundary(stream,
                          [&](rtamt_stream& self) { put(dropped, self.stream.expire(before)); });
}

size_t rtamt_stream_size(const rtamt_stream* stream) {
    return stream == nullptr ? 0 : stream->stream.size();
}

size_t rtamt_stream_waiting(const rtamt_stream* stream) {
    return stream == nullptr ? 0 : stream->stream.waiting();
}

uint64_t rtamt_stream_late(const rtamt_stream* stream) {
    return stream == nullptr ? 0 : stream->stream.late();
}

rtamt_status rtamt_stream_save(rtamt_stream* stream, void* state, size_t room, size_t* size) {
    return error_boundary(stream, [&](rtamt_stream& self) {
        const std::vector<std::uint8_t> bytes = self.stream.snapshot();
        save(
            state, room, size, [&] { return bytes.size(); },
            [&](std::span<std::uint8_t> out) { std::ranges::copy(bytes, out.begin()); });
    });
}

} // extern "C"
