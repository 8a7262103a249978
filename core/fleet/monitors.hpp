// A fleet with a monitor for each key: dense time, and the verdict modes for which there are no
// records.
//
// A batch runs on copies of the monitors of its keys, which then replace them: a batch that fails
// changes nothing.
//
// Cost: of each key of a batch a copy, by its state, and of each sample that of its monitor.
// Memory: the sum over the monitors.
#pragma once

#include "key_monitor.hpp"
#include "keys.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace rtamt::fleet {

// Samples of a batch: key, time, and of each input a column of values. Where `uppers` has a column,
// the values are bounds, of which it has the upper ones; where `given` has one, samples with 0 have
// no value of the input. Either may be empty, and so has no columns.
struct MonitorBatch {
    KeySpan keys;
    const double* times = nullptr;
    std::span<const double* const> columns; // null: no sample has a value
    std::span<const double* const> uppers;
    std::span<const std::uint8_t* const> given;

    [[nodiscard]] std::size_t size() const noexcept { return keys.size(); }
};

class Monitors {
  public:
    // Throws std::invalid_argument with one sentence.
    Monitors(MonitorProgram program, std::size_t capacity);

    // What a batch, or a watermark, has made known: of each sample or key two values at the start
    // of the trace, where the mode has such, and rows of other instants.
    struct Report {
        std::vector<AtStart> at_start;
        std::vector<Row> rows;
    };

    // A sample that is wrong.
    struct Wrong {
        std::size_t index = 0;
        std::string sentence;
        bool undefined = false;
    };

    // Calls `look` with what a batch makes known before anything changes: what it throws leaves
    // everything as it was.
    using Look = std::function<void(const Report&)>;
    [[nodiscard]] std::optional<Wrong> update(const MonitorBatch& batch, const Look& look);
    // No sample at or before a time will come, of any key.
    [[nodiscard]] std::optional<Wrong> watermark(double time, const Look& look);

    // Forgets keys; returns the index of the first that is not there, and forgets none then.
    [[nodiscard]] std::optional<std::size_t> drop(const KeySpan& keys);
    // Forgets the keys whose newest sample is before a time; returns how many.
    std::size_t expire(double before);

    [[nodiscard]] const MonitorProgram& program() const noexcept { return *program_; }
    [[nodiscard]] const Keys& keys() const noexcept { return keys_; }
    [[nodiscard]] std::size_t size() const noexcept { return keys_.size(); }
    [[nodiscard]] std::uint64_t late() const noexcept { return late_; }

    // docs/reference/fleet-state.md
    [[nodiscard]] std::vector<std::uint8_t> snapshot() const;
    // Throws std::invalid_argument with one sentence. `capacity`: 0 for that of the state.
    [[nodiscard]] static Monitors restore(MonitorProgram program, std::size_t capacity,
                                          std::span<const std::uint8_t> bytes);

  private:
    struct Key {
        std::unique_ptr<KeyMonitor> monitor;
        double newest = std::numeric_limits<double>::quiet_NaN(); // the time of its newest sample
    };

    std::unique_ptr<const MonitorProgram> program_; // monitors point to it
    std::size_t capacity_;
    Keys keys_;
    std::vector<Key> monitors_; // by place
    std::uint64_t late_ = 0;    // samples that were
    std::vector<Bounds> values_;
    std::vector<std::uint8_t> given_;

    struct Twin;

    [[nodiscard]] std::optional<std::uint32_t> place_of(const KeySpan& keys,
                                                        std::size_t index) noexcept;
    [[nodiscard]] Key twin_of(std::uint32_t place) const;
    [[nodiscard]] KeySample sample_of(const MonitorBatch& batch, std::size_t index);
    [[nodiscard]] std::optional<Wrong> run(const MonitorBatch& batch, std::vector<Twin>& twins,
                                           Report& report, std::uint64_t& late);
    std::uint32_t add(const KeySpan& keys, std::size_t index);
    void erase(std::uint32_t place) noexcept;
    void forget_from(std::size_t old_size) noexcept;
    [[nodiscard]] std::string name_of(std::uint32_t place) const;
};

} // namespace rtamt::fleet
