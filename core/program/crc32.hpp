// The CRC-32 of zlib, PNG and Ethernet (reflected polynomial 0xEDB88320), by a table of 256.
//
// Cost: one table look-up a byte; programs are small and are read once.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace rtamt {

namespace detail {

[[nodiscard]] constexpr std::array<std::uint32_t, 256> crc32_table() noexcept {
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t byte = 0; byte < 256; ++byte) {
        std::uint32_t value = byte;
        for (int bit = 0; bit < 8; ++bit) {
            value = (value & 1U) != 0 ? (value >> 1U) ^ 0xEDB88320U : value >> 1U;
        }
        table[byte] = value;
    }
    return table;
}

} // namespace detail

[[nodiscard]] constexpr std::uint32_t crc32(std::span<const std::uint8_t> bytes) noexcept {
    constexpr auto table = detail::crc32_table();
    std::uint32_t value = 0xFFFFFFFFU;
    for (const std::uint8_t byte : bytes) {
        value = table[(value ^ byte) & 0xFFU] ^ (value >> 8U);
    }
    return ~value;
}

} // namespace rtamt
