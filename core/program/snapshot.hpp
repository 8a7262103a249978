// The state of a monitor as bytes: written by one monitor and read by another one of the same
// program, which then continues as the first would.
//
// Every part lists what it holds once, in its transfer(), for both directions. Buffers that only
// serve within an update are no part of it. The bytes are those of this layout, the same on all
// machines with the same order of bytes and length of addresses, and refused on others.
// They may come from anywhere: whatever is used to find memory, or an order is relied upon, is
// required to be as the part itself would have left it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <vector>

namespace rtamt {

class Snapshot {
  public:
    // For writing.
    Snapshot() { put(&layout, sizeof(layout)); }

    // For reading; the bytes must outlive it.
    explicit Snapshot(std::span<const std::uint8_t> bytes) : rest_(bytes), loading_(true) {
        std::uint32_t found = 0;
        item(found);
        if (found != layout) foreign();
    }

    [[nodiscard]] bool loading() const noexcept { return loading_; }

    // One value, copied as it lies in memory.
    template <class Value>
        requires std::is_trivially_copyable_v<Value>
    void item(Value& value) {
        values(&value, 1);
    }

    void item(bool& flag) {
        auto byte = static_cast<std::uint8_t>(flag);
        item(byte);
        require(byte <= 1);
        flag = byte != 0;
    }

    template <class Value>
    void item(std::optional<Value>& optional) {
        bool present = optional.has_value();
        Value value = optional.value_or(Value{});
        item(present);
        item(value);
        optional = present ? std::optional(value) : std::nullopt;
    }

    // The number of values that follow, of a given size in bytes.
    void count(std::size_t& count, std::size_t size) {
        item(count);
        require(count <= rest_.size() / size);
    }

    // What does not hold for what was read makes it no state of this program.
    void require(bool holds) const {
        if (loading_ && !holds) foreign();
    }

    // As many as both sides know.
    template <class Value>
        requires std::is_trivially_copyable_v<Value>
    void values(Value* values, std::size_t count) {
        if (count == 0) return; // then there may be no memory
        loading_ ? get(values, count, sizeof(Value)) : put(values, count * sizeof(Value));
    }

    // What was written.
    [[nodiscard]] const std::vector<std::uint8_t>& bytes() const noexcept { return written_; }

    // Nothing may be left to read.
    void end() const {
        if (!rest_.empty()) foreign();
    }

  private:
    // To be raised whenever a part holds something else than before. Of another order of bytes, or
    // length of an address, it is another number.
    static constexpr std::uint32_t layout = 8U | (sizeof(void*) == 8 ? 0U : 0x10000U);

    std::vector<std::uint8_t> written_;
    std::span<const std::uint8_t> rest_;
    bool loading_ = false;

    [[noreturn]] static void foreign() {
        throw std::invalid_argument("This is not the state of a monitor of this program.");
    }

    void put(const void* memory, std::size_t size) {
        const std::size_t begin = written_.size();
        written_.resize(begin + size);
        std::memcpy(written_.data() + begin, memory, size);
    }

    void get(void* memory, std::size_t count, std::size_t size) {
        if (count > rest_.size() / size) foreign();
        std::memcpy(memory, rest_.data(), count * size);
        rest_ = rest_.subspan(count * size);
    }
};

} // namespace rtamt
