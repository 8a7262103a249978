#include "program/crc32.hpp"

#include "check.hpp"

#include <array>
#include <string_view>

static std::uint32_t of(std::string_view text) {
    return rtamt::crc32({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

TEST_CASE("agrees with published check values") {
    CHECK(of("123456789") == 0xCBF43926U);
    CHECK(of("The quick brown fox jumps over the lazy dog") == 0x414FA339U);
    CHECK(of("a") == 0xE8B7BE43U);
    CHECK(of("") == 0U);
}

TEST_CASE("notices every single bit") {
    std::array<std::uint8_t, 16> bytes{};
    const std::uint32_t before = rtamt::crc32(bytes);
    for (std::size_t bit = 0; bit < 128; ++bit) {
        bytes[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
        CHECK(rtamt::crc32(bytes) != before);
        bytes[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
    }
}
