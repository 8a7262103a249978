// Many monitors of one program in discrete time: a record for each key, in one arena.
//
// A batch is checked as a whole before any record changes. Then its samples run in blocks of up to
// 64 keys, instruction by instruction; a key that occurs several times is in as many blocks, in
// the order of the batch. Only where a value that may be undefined is computed from state are the
// records of the batch copied first, so that they can be put back.
//
// Cost: a few accesses to memory a sample, requested ahead, and what the instructions take. Memory:
// memory_of(keys); of the arena only what keys have used.
#pragma once

#include "../discrete/arena.hpp"
#include "batch.hpp"
#include "keys.hpp"
#include "layout.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace rtamt::fleet {

// What a batch has made known of an output, in its order; `when` is the time that a value is for.
// The values of what is not known are 0, its times NaN. `warming` may be null.
struct Output {
    double* values = nullptr;
    std::uint8_t* known = nullptr;
    double* when = nullptr;
    std::uint8_t* warming = nullptr;
};

class Fleet {
  public:
    struct Settings {
        double period = 1.0;    // seconds
        double tolerance = 0.0; // of a gap, in periods
        bool restart = false;   // whether a gap begins a new trace of its key; else it is rejected
        std::size_t capacity = 0;
    };

    // `names` are those of the inputs.
    Fleet(Program program, std::vector<std::string> names, const Settings& settings);

    [[nodiscard]] std::optional<Rejected> update(const Batch& batch,
                                                 std::span<const Output> outputs);

    // Forgets keys; returns the index of the first that is not there, and forgets none then.
    [[nodiscard]] std::optional<std::size_t> drop(const KeySpan& keys);

    // Forgets the keys whose last sample is before a time; returns how many.
    std::size_t expire(double before);

    [[nodiscard]] bool contains(const KeySpan& keys, std::size_t index) noexcept {
        return place_of(keys, index).has_value();
    }
    [[nodiscard]] double last_time(std::size_t place) noexcept {
        return Layout::header(record(place)).last;
    }
    [[nodiscard]] const Keys& keys() const noexcept { return keys_; }
    [[nodiscard]] std::size_t size() const noexcept { return keys_.size(); }
    [[nodiscard]] const Settings& settings() const noexcept { return settings_; }
    [[nodiscard]] const Program& program() const noexcept { return program_; }
    [[nodiscard]] std::size_t record_size() const noexcept { return layout_.record_size(); }
    [[nodiscard]] bool warming() const noexcept { return layout_.warming(); }
    [[nodiscard]] std::size_t bytes() const noexcept {
        return size() * record_size() + keys_.bytes();
    }

    // The state of all keys (state.cpp): docs/reference/fleet-state.md.
    [[nodiscard]] std::size_t snapshot_size() const noexcept;
    void snapshot(std::span<std::uint8_t> out) const noexcept;

    // A fleet in the state that these bytes describe, maybe of a fleet with another program. Throws
    // std::invalid_argument with one sentence. `capacity`: 0 for what the bytes have.
    [[nodiscard]] static Fleet restore(Program program, std::vector<std::string> names,
                                       Settings settings, std::span<const std::uint8_t> bytes);

  private:
    Program program_;
    std::vector<std::string> names_;
    Settings settings_;
    double slack_;
    Layout layout_;
    discrete::Arena memory_;
    std::byte* arena_;
    Keys keys_;
    std::uint32_t marks_ = 0; // marks above are indices of this batch

    // The program as it runs.
    std::vector<double> registers_;
    std::vector<const double*> at_;      // by instruction, its register or column
    std::vector<double*> own_;           // by instruction, where it writes
    std::vector<std::uint32_t> running_; // instructions with kernels, in order
    std::vector<std::uint32_t> guarded_; // those of them that can fail, or that one depends on
    std::vector<std::uint32_t> inputs_;  // instructions that are inputs
    std::vector<std::uint32_t> failing_; // instructions that can fail
    bool guarded_state_ = false;         // whether a guarded one has state

    // Of the batch that is being taken.
    std::vector<std::uint32_t> places_;
    std::vector<std::uint32_t> order_; // indices, each key once in a stretch of these
    std::vector<std::size_t> rounds_;  // the ends of these stretches; none: one, in order
    std::vector<std::uint32_t> turns_; // by index, the number of earlier samples of its key
    std::vector<std::byte> saved_;

    [[nodiscard]] std::byte* record(std::size_t place) noexcept {
        return arena_ + place * layout_.record_size();
    }

    Fleet(Program program, std::vector<std::string> names, const Settings& settings, bool warming);

    struct Running;

    // Whether two samples may be so far apart.
    [[nodiscard]] bool fits(double gap) const noexcept {
        return gap > 0.0 && std::fabs(gap - settings_.period) <= slack_;
    }

    // Whether a gap to a time may be one period, and look longer or shorter because both times are
    // rounded: seconds since 1970 are doubles 0.24 µs apart.
    [[nodiscard]] bool may_fit(double gap, double time) const noexcept {
        const double spacing =
            std::nextafter(std::fabs(time), std::numeric_limits<double>::infinity()) -
            std::fabs(time);
        return std::fabs(gap - settings_.period) <= slack_ + spacing;
    }

    [[nodiscard]] std::optional<Rejected> take(const Batch& batch, std::span<const Output> outputs,
                                               std::size_t old_size);
    template <class Key>
    [[nodiscard]] std::optional<Rejected> admit(std::span<const Key> keys, const Batch& batch,
                                                std::size_t count);
    void describe(Rejected& wrong, const Batch& batch);
    void take_turns(std::size_t count, std::uint32_t most);

    template <class Visit>
    bool each_block(const Batch& batch, Visit&& visit);
    void request(std::size_t begin, std::size_t end) noexcept;
    [[nodiscard]] std::optional<Rejected> run(const Batch& batch, std::span<const Output> outputs);
    void begin_again(const Batch& batch, Running& running);
    void load(const Batch& batch, const Running& running);
    void compute(const Running& running, std::span<const std::uint32_t> instructions);
    void settle(const Running& running, std::uint32_t instruction);
    [[nodiscard]] std::optional<Rejected> undefined(const Batch& batch, const Running& running);
    void deliver(const Batch& batch, const Running& running, std::span<const Output> outputs);

    void add_time(ClockState& clock, const Header& header, double time,
                  double* ring) const noexcept;
    [[nodiscard]] double time_at(const ClockState& clock, const Header& header, std::int64_t sample,
                                 const double* ring) const noexcept;

    [[nodiscard]] std::optional<std::uint32_t> place_of(const KeySpan& keys,
                                                        std::size_t index) noexcept;
    void erase(std::uint32_t place) noexcept;
    void forget_from(std::size_t old_size) noexcept;
    void save(std::size_t count, std::size_t old_size);
    void put_back(std::size_t count, std::size_t old_size) noexcept;
    [[nodiscard]] std::int64_t exact_from(std::byte* record, std::uint32_t instruction) const;
};

} // namespace rtamt::fleet
