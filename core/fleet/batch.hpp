// A batch of samples, and why one is rejected.
#pragma once

#include "../discrete/undefined.hpp"
#include "keys.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace rtamt::fleet {

// Samples of a batch: key, time and a value of each input.
struct Batch {
    KeySpan keys;
    const double* times = nullptr;
    std::span<const double* const> columns;

    [[nodiscard]] std::size_t size() const noexcept { return keys.size(); }
};

// Why a batch was rejected: the index in it, and what is wrong there.
struct Rejected {
    enum class Reason : std::uint8_t { time, gap, value, undefined, full };

    std::size_t index = 0;
    Reason reason{};
    std::int64_t samples = 0;                  // of the key so far
    std::optional<double> last = std::nullopt; // its time before
    std::uint32_t instruction = 0;             // without a value; of `value` the input
    std::optional<double> time =
        std::nullopt; // of the undefined value, or of the sample after a gap
};

// The first value of a batch that is NaN.
[[nodiscard]] inline std::optional<Rejected> wrong_value(const Batch& batch) {
    std::optional<Rejected> wrong;
    std::size_t count = batch.size();
    for (std::size_t input = 0; input < batch.columns.size(); ++input) {
        const std::size_t place = discrete::first_undefined<Real>(batch.columns[input], {0, count});
        if (place == discrete::Kernel::defined) continue;
        wrong = Rejected{place, Rejected::Reason::value, 0, {}, static_cast<std::uint32_t>(input)};
        count = place;
    }
    return wrong;
}

// Throws std::invalid_argument for too many samples, or for keys of another kind than those there.
inline void require_fitting(const Batch& batch, Keys& keys) {
    if (batch.size() > Keys::none / 2) {
        throw std::invalid_argument("A batch has at most 2147483647 samples: split it.");
    }
    if (keys.size() == 0) keys.set_kind(batch.keys.kind);
    if (keys.kind() != batch.keys.kind) {
        throw std::invalid_argument(
            "The keys of a fleet are all integers, all texts, or all bytes.");
    }
}

} // namespace rtamt::fleet
