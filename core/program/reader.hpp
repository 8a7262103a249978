// Numbers and text from bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>

namespace rtamt {

// Reads numbers in little endian order; the caller has checked that the bytes are there.
class Reader {
  public:
    explicit Reader(std::span<const std::uint8_t> bytes) noexcept : bytes_(bytes) {}

    template <class Unsigned>
    [[nodiscard]] Unsigned take() noexcept {
        static_assert(std::is_unsigned_v<Unsigned>);
        std::uint64_t value = 0;
        for (std::size_t i = 0; i < sizeof(Unsigned); ++i) {
            value |= std::uint64_t{bytes_[i]} << (8U * i);
        }
        bytes_ = bytes_.subspan(sizeof(Unsigned));
        return static_cast<Unsigned>(value);
    }

    [[nodiscard]] std::string text(std::size_t length) {
        const auto part = bytes_.first(length);
        bytes_ = bytes_.subspan(length);
        return {part.begin(), part.end()};
    }

    [[nodiscard]] std::size_t left() const noexcept { return bytes_.size(); }

  private:
    std::span<const std::uint8_t> bytes_;
};

} // namespace rtamt
