// The layout of a key's record: the place and the identity of each instruction's state.
//
// A record: the header; the clock, if a value is known later than its sample; the heads of all
// instructions with state; after a change of the requirement, from which slot on each of them and
// each output is exact; the tails.
#pragma once

#include "../program/program.hpp"
#include "kernel.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace rtamt::fleet {

struct Header {
    double last;          // the time of the last sample
    std::int64_t samples; // so far
};

// Which times the last samples had, as discrete/timestamps.hpp.
struct ClockState {
    double origin;
    std::int64_t
        regular;        // samples before the first one that was not a whole number of periods later
    std::uint64_t next; // cell of the ring to be written next
};

// Raised when what an instruction keeps in a record changes.
inline constexpr std::uint16_t state_version = 1;

class Layout {
  public:
    // An instruction with state.
    struct Part {
        std::uint32_t instruction;
        std::uint64_t hash;
    };

    // `names` are those of the inputs; `warming`: whether records hold from when on they are exact.
    Layout(const Program& program, std::span<const std::string> names, bool warming);

    [[nodiscard]] std::size_t record_size() const noexcept { return record_size_; }
    // Bytes at the front that every sample reads.
    [[nodiscard]] std::size_t hot_size() const noexcept { return hot_size_; }
    [[nodiscard]] bool clocked() const noexcept { return times_ != 0; }
    [[nodiscard]] bool warming() const noexcept { return warming_; }
    // How many times the ring of times has; 0 without a clock.
    [[nodiscard]] std::size_t times() const noexcept { return times_; }

    [[nodiscard]] std::span<const Part> parts() const noexcept { return parts_; }
    // By instruction; null for what has none.
    [[nodiscard]] const Kernel* kernel(std::uint32_t instruction) const noexcept {
        return kernels_[instruction].get();
    }
    [[nodiscard]] std::uint64_t hash(std::uint32_t instruction) const noexcept {
        return hashes_[instruction];
    }

    [[nodiscard]] static Header& header(std::byte* record) noexcept {
        return *reinterpret_cast<Header*>(record);
    }
    [[nodiscard]] static ClockState& clock(std::byte* record) noexcept {
        return *reinterpret_cast<ClockState*>(record + sizeof(Header));
    }
    [[nodiscard]] double* ring(std::byte* record) const noexcept {
        return reinterpret_cast<double*>(record + ring_offset_);
    }
    [[nodiscard]] std::size_t ring_offset() const noexcept { return ring_offset_; }
    [[nodiscard]] std::size_t exact_offset() const noexcept { return exact_offset_; }
    // The first sample whose time is known; from which slot on each part, and each output, is
    // exact.
    [[nodiscard]] std::int64_t* exact(std::byte* record) const noexcept {
        return reinterpret_cast<std::int64_t*>(record + exact_offset_);
    }

    // The record of a key without a sample; the memory is zero.
    void start(std::byte* record) const noexcept;

  private:
    std::vector<std::unique_ptr<Kernel>> kernels_; // by instruction
    std::vector<std::uint64_t> hashes_;            // by instruction
    std::vector<Part> parts_;
    std::size_t record_size_ = 0;
    std::size_t hot_size_ = 0;
    std::size_t exact_offset_ = 0;
    std::size_t ring_offset_ = 0;
    std::size_t times_ = 0;
    bool warming_;
};

} // namespace rtamt::fleet
