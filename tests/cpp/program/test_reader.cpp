#include "program/reader.hpp"

#include "check.hpp"

#include <array>

TEST_CASE("numbers are little endian and text is taken as it is") {
    const std::array<std::uint8_t, 9> bytes{0x01, 0x02, 0x03, 0x00, 0x00, 0x80, 'a', 'b', 0xFF};
    rtamt::Reader reader(bytes);
    CHECK(reader.left() == 9);
    CHECK(reader.take<std::uint16_t>() == 0x0201);
    CHECK(reader.take<std::uint32_t>() == 0x80000003U);
    CHECK(reader.text(2) == "ab");
    CHECK(reader.left() == 1);
    CHECK(reader.take<std::uint8_t>() == 0xFF);
}
