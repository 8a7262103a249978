// Samples that arrive in any order, and leave in the order of their times: a buffer for each key.
//
// The watermark of a key is its newest time minus the lateness, or the watermark of all keys if
// that is later. A sample waits until the watermark has reached it. One that is before the
// watermark, or not after a sample that has left, or as old as one that waits, is late and
// diverted. So what leaves depends on the order of arrival only where samples are late, and never
// on how they are divided into batches.
//
// What waits can fill gaps: where whole periods are missing, the last value is held.
//
// A batch is offered, and then accepted or withdrawn; a batch that is withdrawn has changed
// nothing.
//
// Cost: a look-up of the key a sample, and a step for each sample of the key that waits and is
// newer. Memory: 40 bytes a key, and 24 bytes and its values for each sample that waits.
#pragma once

#include "batch.hpp"
#include "keys.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace rtamt::fleet {

class ReorderBuffer {
  public:
    struct Settings {
        std::optional<double>
            lateness; // seconds; none: a sample that is not the newest is rejected
        std::size_t capacity = 0;
        double period = 1.0;    // seconds
        double tolerance = 0.0; // of a gap, in periods
        std::size_t filled = 0; // how many values may be held in a gap; 0: gaps are not filled
    };

    // Samples that have left, those of each key in the order of their times.
    struct Ready {
        std::vector<std::int64_t> places; // in the batch: of the sample, or of one of its key;
                                          // without a batch, of the key
        std::vector<std::uint8_t> own;    // whether it is this sample of the batch
        std::vector<std::uint8_t> fills;  // whether it fills the gap before the next that does not
        std::vector<double> times;
        std::vector<std::vector<double>> columns;

        [[nodiscard]] std::size_t size() const noexcept { return times.size(); }
        // That of a sample that came: this one, or the one after the gap that this one fills.
        [[nodiscard]] std::size_t sample_of(std::size_t index) const noexcept {
            while (fills[index] != 0)
                ++index;
            return index;
        }
    };

    // `names` identify the inputs in a state.
    ReorderBuffer(std::vector<std::string> names, const Settings& settings);

    // Takes a batch and notes which of its samples are late; what leaves is in ready() until the
    // batch is accepted or withdrawn, as it has to be next unless it is rejected.
    [[nodiscard]] std::optional<Rejected> offer(const Batch& batch, std::uint8_t* late);

    // The same without samples: none before this time will arrive. `places` are those of keys.
    [[nodiscard]] std::optional<Rejected> advance(double watermark);

    // The same of some keys alone: all that waits of them leaves. Keys that are not there are left
    // out.
    [[nodiscard]] std::optional<Rejected> release(const KeySpan& keys);

    [[nodiscard]] const Ready& ready() const noexcept { return ready_; }
    void accept() noexcept;
    void withdraw() noexcept;

    // Forgets keys with what waits of them; returns the index of the first that is not there, and
    // forgets none then.
    [[nodiscard]] std::optional<std::size_t> drop(const KeySpan& keys);

    // Forgets the sample of a time that waits, of the first of some keys; returns whether there was
    // one. The watermark stays.
    [[nodiscard]] bool discard(const KeySpan& keys, double time);

    // Whether a sample of a key has left.
    [[nodiscard]] bool has_left(std::uint32_t place) const noexcept {
        return lines_[place].left != never;
    }
    [[nodiscard]] std::optional<std::uint32_t> place_of(const KeySpan& keys, std::size_t index);

    // The places of the keys whose newest sample is before a time.
    [[nodiscard]] std::vector<std::uint32_t> stale(double before) const;

    [[nodiscard]] const Keys& keys() const noexcept { return keys_; }
    [[nodiscard]] std::size_t size() const noexcept { return lines_.size(); }
    [[nodiscard]] std::size_t waiting() const noexcept { return times_.size() - free_.size(); }
    [[nodiscard]] std::uint64_t late() const noexcept { return late_; }
    [[nodiscard]] std::size_t bytes() const noexcept;

    // What waits and what the watermark follows from, as bytes (reorder_state.cpp), and back.
    [[nodiscard]] std::vector<std::uint8_t> snapshot() const;
    [[nodiscard]] static ReorderBuffer restore(std::vector<std::string> names,
                                               const Settings& settings,
                                               std::span<const std::uint8_t> bytes);

  private:
    static constexpr double never = -std::numeric_limits<double>::infinity();
    static constexpr std::uint32_t nothing = std::numeric_limits<std::uint32_t>::max();

    struct Line {
        double newest = never;         // time of the newest sample that was not late
        double left = never;           // time of the last one that left
        std::uint32_t first = nothing; // of those that wait, in the order of their times
        std::uint32_t last = nothing;
        std::uint64_t touched = 0; // number of the batch that changed it last
    };
    struct Saved {
        std::uint32_t place = 0;
        Line line;
        std::size_t end = 0; // of its samples in saved_waiting_
    };

    std::vector<std::string> names_;
    Settings settings_;
    double slack_;
    double watermark_ = never;
    std::uint64_t late_ = 0;
    Keys keys_;
    std::vector<Line> lines_; // by place of the key
    std::vector<double>
        held_; // by place, the last values that left, where gaps are filled; NaN: not known

    // The samples that wait.
    std::vector<double> times_;
    std::vector<double> values_;       // of each sample, one an input
    std::vector<std::uint32_t> next_;  // of the same key
    std::vector<std::int64_t> origin_; // index in this batch, or -1
    std::vector<std::uint32_t> free_;

    // Of the batch that was offered.
    std::uint64_t number_ = 0;
    std::size_t old_size_ = 0;
    std::uint64_t old_late_ = 0;
    double old_watermark_ = never;
    std::vector<Saved> saved_;
    std::vector<std::uint32_t> saved_waiting_;
    std::vector<double> saved_held_;
    std::vector<std::uint32_t> added_;
    std::vector<std::uint32_t> gone_;
    Ready ready_;

    [[nodiscard]] double watermark_of(const Line& line) const noexcept;
    [[nodiscard]] bool is_late(const Line& line, double time) const noexcept;
    [[nodiscard]] std::size_t inputs() const noexcept { return names_.size(); }

    void begin();
    template <class Key>
    [[nodiscard]] std::optional<Rejected> offer_all(std::span<const Key> keys, const Batch& batch,
                                                    std::uint8_t* late);
    [[nodiscard]] std::optional<Rejected> offer_one(const Batch& batch, std::size_t index,
                                                    std::uint32_t place, std::uint8_t& late);
    void touch(std::uint32_t place);
    [[nodiscard]] std::uint32_t make_room();
    [[nodiscard]] bool wait(Line& line, double time, const Batch& batch, std::size_t index);
    [[nodiscard]] std::optional<Rejected> release(std::uint32_t place, std::int64_t at,
                                                  double watermark);
    template <class Visit>
    [[nodiscard]] std::optional<Rejected> without_samples(Visit&& visit);
    template <class Value>
    [[nodiscard]] std::optional<Rejected> leave(std::uint32_t place, std::int64_t at, bool own,
                                                double time, Value&& value);
    void erase(std::uint32_t place) noexcept;
};

} // namespace rtamt::fleet
