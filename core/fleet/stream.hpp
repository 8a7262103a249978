// A fleet with samples in any order: a reorder buffer in front of it.
//
// A batch changes both or, where it is rejected, neither. What has left the buffer is monitored in
// the same call, whether it is of the batch or waited.
#pragma once

#include "fleet.hpp"
#include "reorder_buffer.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rtamt::fleet {

class Stream {
  public:
    // What a gap between two samples that have left does; the numbers are those of a state.
    enum class Gaps : std::uint8_t { reject, restart, hold };
    static constexpr std::size_t longest_hold = 10'000; // values that are held in a gap

    // Why a batch was rejected. Of a sample that waited, `key` and `time`: which one; and there is
    // no index. Of a value that fills a gap, the sample is the one after the gap.
    struct Failure {
        Rejected why;
        bool waited = false;
        std::int64_t key = 0;
        std::string text;
        double time = 0.0;
    };

    // A sample that has left: its key (a text where keys are texts) and time, and of each output
    // what it made known.
    struct Released {
        KeyKind kind = KeyKind::none;
        std::vector<std::int64_t> integers;
        std::vector<std::string> texts;
        std::vector<double> times;
        std::vector<double> values;        // output by output, one a sample
        std::vector<double> when;          // likewise
        std::vector<std::uint8_t> known;   // likewise
        std::vector<std::uint8_t> warming; // likewise

        [[nodiscard]] std::size_t size() const noexcept { return times.size(); }
    };

    // `fleet` has the names of the inputs `names`, and begins a new trace after a gap if `gaps`
    // says so.
    Stream(Fleet fleet, std::vector<std::string> names, double lateness, Gaps gaps);

    // Takes a batch and notes which of its samples are late.
    [[nodiscard]] std::optional<Failure> take(const Batch& batch, std::uint8_t* late);
    // No sample before this time will arrive.
    [[nodiscard]] std::optional<Failure> advance(double watermark);
    // What the last call that succeeded let leave.
    [[nodiscard]] const Released& released() const noexcept { return released_; }

    [[nodiscard]] bool discard(const KeySpan& key, double time) {
        return buffer_.discard(key, time);
    }
    [[nodiscard]] std::optional<std::size_t> drop(const KeySpan& keys);
    std::size_t expire(double before);

    [[nodiscard]] Fleet& fleet() noexcept { return fleet_; }
    [[nodiscard]] const Fleet& fleet() const noexcept { return fleet_; }
    [[nodiscard]] const Keys& keys() const noexcept { return buffer_.keys(); }
    // Whether keys are numbers.
    [[nodiscard]] bool integers() const noexcept { return !buffer_.keys().textual(); }
    [[nodiscard]] std::size_t size() const noexcept { return buffer_.size(); }
    [[nodiscard]] std::size_t waiting() const noexcept { return buffer_.waiting(); }
    [[nodiscard]] std::uint64_t late() const noexcept { return buffer_.late(); }

    // docs/reference/fleet-state.md
    [[nodiscard]] std::vector<std::uint8_t> snapshot() const;
    // Throws std::invalid_argument with one sentence. `settings`: of the fleet, with the capacity 0
    // for that of the state; gaps and lateness are those of the state.
    [[nodiscard]] static Stream restore(Program program, const std::vector<std::string>& names,
                                        Fleet::Settings settings,
                                        std::span<const std::uint8_t> bytes);

  private:
    Fleet fleet_;
    double lateness_;
    Gaps gaps_;
    ReorderBuffer buffer_;
    Released released_;

    Stream(Fleet fleet, double lateness, Gaps gaps, ReorderBuffer buffer)
        : fleet_(std::move(fleet)), lateness_(lateness), gaps_(gaps), buffer_(std::move(buffer)) {}

    [[nodiscard]] static ReorderBuffer::Settings settings_of(const Fleet::Settings& fleet,
                                                             double lateness, Gaps gaps) noexcept {
        return {lateness, fleet.capacity, fleet.period, fleet.tolerance,
                gaps == Gaps::hold ? longest_hold : 0};
    }
    [[nodiscard]] std::optional<Failure> monitor(const KeySpan* keys);
    [[nodiscard]] KeySpan keys_of(const Released& released, std::vector<std::string_view>& held);
};

} // namespace rtamt::fleet
