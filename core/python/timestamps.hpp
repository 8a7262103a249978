// Timestamps in seconds: their order, and the sampling period that they show.
#pragma once

#include <optional>
#include <span>

namespace rtamt::python {

// Whether the timestamps are numbers of seconds that increase, also from `before` on.
[[nodiscard]] bool ordered(std::span<const double> times, std::optional<double> before) noexcept;

// Whether they are one period apart, within a fraction of it.
[[nodiscard]] bool regular(std::span<const double> times, std::optional<double> before,
                           double period, double tolerance) noexcept;

// As infer_period() in rtamt.signals.inferred_period: the median gap, or the mean gap of rounded
// timestamps, as the shortest decimal within its precision; 1 for a single timestamp. Nothing for
// timestamps that may have been floats of 32 bits, and where the period is uncertain.
[[nodiscard]] std::optional<double> inferred_period(std::span<const double> times);

// As has_period() in rtamt.signals.sampling_period, of timestamps in order: whether more than half
// of the gaps are a period, and none that a number with one digit less describes as well. `coarse`:
// one in that digit.
[[nodiscard]] bool has_period(std::span<const double> times, double period, double coarse) noexcept;

} // namespace rtamt::python
