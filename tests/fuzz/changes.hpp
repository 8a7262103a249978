// Changes of bytes, as other bytes choose them.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <vector>

namespace changes {

using Bytes = std::vector<std::uint8_t>;

// Numbers from bytes; zeros when these are used up.
class Choices {
  public:
    Choices(const std::uint8_t* data, std::size_t size) : rest_(data, size) {}

    template <class Number>
    [[nodiscard]] Number take() {
        Number number{};
        const std::size_t size = rest_.size() < sizeof number ? rest_.size() : sizeof number;
        if (size != 0) std::memcpy(&number, rest_.data(), size);
        rest_ = rest_.subspan(size);
        return number;
    }
    // A number below a limit, which is not 0.
    [[nodiscard]] std::size_t below(std::size_t limit) { return take<std::uint32_t>() % limit; }

  private:
    std::span<const std::uint8_t> rest_;
};

// A number that misleads, beside the one that is there.
[[nodiscard]] inline std::uint64_t misleading(std::uint64_t now, Choices& choices) {
    using Limits = std::numeric_limits<std::int64_t>;
    constexpr auto most = static_cast<std::uint64_t>(Limits::max());
    const std::array<std::uint64_t, 16> numbers{0,
                                                1,
                                                2,
                                                7,
                                                now + 1,
                                                now - 1,
                                                most / 4,
                                                most / 4 - 1,
                                                most / 2,
                                                most,
                                                most + 1,
                                                ~std::uint64_t{0},
                                                std::bit_cast<std::uint64_t>(-1.0),
                                                std::bit_cast<std::uint64_t>(1e300),
                                                0x7FF0'0000'0000'0000U, // infinity
                                                0x7FF8'0000'0000'0000U};
    return numbers[choices.below(numbers.size())];
}

// Changes bytes at up to three places; `other`: what may be copied into them beside themselves.
inline void change(Bytes& bytes, const Bytes& other, Choices& choices) {
    for (std::size_t count = 1 + choices.below(3); count > 0 && !bytes.empty(); --count) {
        const std::size_t place = choices.below(bytes.size());
        const std::size_t left = bytes.size() - place;
        const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(place);
        switch (choices.below(8)) {
        case 0:
            bytes[place] ^= static_cast<std::uint8_t>(1U << choices.below(8));
            break;
        case 1:
            bytes[place] = static_cast<std::uint8_t>(choices.below(256));
            break;
        case 2: // the end, or a part
            bytes.erase(begin, choices.below(2) == 0 ? bytes.end() : begin + 1);
            break;
        case 3: { // a part of the same or of others
            const Bytes from = other.empty() || choices.below(2) == 0 ? bytes : other;
            const std::size_t first = choices.below(from.size());
            const std::size_t length = 1 + choices.below(from.size() - first);
            bytes.insert(begin, from.begin() + static_cast<std::ptrdiff_t>(first),
                         from.begin() + static_cast<std::ptrdiff_t>(first + length));
            break;
        }
        default: { // most numbers have four or eight bytes
            std::uint64_t word = 0;
            const std::size_t size = choices.below(2) == 0 ? 4 : 8;
            if (left < size) break;
            std::memcpy(&word, bytes.data() + place, size);
            word = misleading(word, choices);
            std::memcpy(bytes.data() + place, &word, size);
        }
        }
    }
}

} // namespace changes
