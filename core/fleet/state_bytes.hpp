// Numbers, one after another, in the bytes of a state; reading checks that they are there.
#pragma once

#include "keys.hpp"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace rtamt::fleet {

[[noreturn]] inline void refuse(const std::string& reason) {
    throw std::invalid_argument("This is not the state of a fleet: " + reason + ".");
}

// Writes numbers one after another; the caller has made room.
class Writer {
  public:
    explicit Writer(std::uint8_t* out) noexcept : out_(out) {}
    template <class Value>
    void put(Value value) noexcept {
        put(&value, sizeof(Value));
    }
    void put(const void* memory, std::size_t size) noexcept {
        if (size != 0) std::memcpy(out_, memory, size);
        out_ += size;
    }
    void put_text(std::string_view text) noexcept {
        put(static_cast<std::uint32_t>(text.size()));
        put(text.data(), text.size());
    }

  private:
    std::uint8_t* out_;
};

class Bytes {
  public:
    explicit Bytes(std::span<const std::uint8_t> rest) noexcept : rest_(rest) {}
    template <class Value>
    [[nodiscard]] Value take() {
        Value value{};
        std::memcpy(&value, take(sizeof(Value)).data(), sizeof(Value));
        return value;
    }
    [[nodiscard]] std::span<const std::uint8_t> take(std::uint64_t size) {
        if (size > rest_.size()) refuse("it ends too early");
        const auto part = rest_.first(static_cast<std::size_t>(size));
        rest_ = rest_.subspan(static_cast<std::size_t>(size));
        return part;
    }
    [[nodiscard]] std::string_view take_text() {
        const auto text = take(take<std::uint32_t>());
        return {reinterpret_cast<const char*>(text.data()), text.size()};
    }
    [[nodiscard]] std::size_t left() const noexcept { return rest_.size(); }

  private:
    std::span<const std::uint8_t> rest_;
};

[[nodiscard]] inline std::size_t key_bytes(const Keys& keys) noexcept {
    if (!keys.textual()) return keys.size() * sizeof(std::uint64_t);
    std::size_t size = 0;
    for (const std::string& text : keys.texts())
        size += sizeof(std::uint32_t) + text.size();
    return size;
}

inline void put_keys(const Keys& keys, Writer& writer) noexcept {
    if (keys.textual()) {
        for (const std::string& text : keys.texts())
            writer.put_text(text);
    } else {
        writer.put(keys.integers().data(), keys.size() * sizeof(std::uint64_t));
    }
}

// Adds so many keys of this kind.
inline void take_keys(Keys& keys, KeyKind kind, std::uint64_t count, Bytes& bytes) {
    keys.set_kind(kind);
    const auto add = [&](auto key) {
        const std::uint64_t code = keys.code(key);
        if (keys.find(key, code) != nullptr) refuse("it has a key twice");
        keys.add(key, code);
    };
    for (std::uint64_t i = 0; i < count; ++i) {
        if (keys.textual()) {
            const std::string_view text = bytes.take_text();
            if (text.ends_with('\0')) refuse("a key ends with the character 0");
            add(text);
        } else {
            add(bytes.take<std::int64_t>());
        }
    }
}

} // namespace rtamt::fleet
