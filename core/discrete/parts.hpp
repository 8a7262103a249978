// One long trace in parts, which are evaluated on several cores.
//
// Windows are local: the values of a part depend on its own samples and on some before and after
// it. Each part is evaluated over these as well, and only its own values are kept. Sums are left
// out, whose rounding depends on where they begin, and so is what remembers everything.
//
// How a trace is parted does not depend on the number of threads, and so no bit of a value does.
//
// Cost: that of the executor, and at most an eighth more for samples that two parts read. Memory:
// an executor a thread.
#pragma once

#include "executor.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace rtamt::discrete {

// How far the values of all instructions reach: from `before` samples before an instant to `after`
// samples after it.
struct Reach {
    std::int64_t before;
    std::int64_t after;
};

// Nothing where values depend on all samples before, where they are sums, or where a call runs.
[[nodiscard]] std::optional<Reach> reach(const Program& program);

// Where the parts of a trace begin, and its end. Parts have at least `least` samples; a trace that
// is too short has one part.
inline constexpr std::size_t shortest_part = std::size_t{1} << 17U;
[[nodiscard]] std::vector<std::size_t> parts(const Program& program, std::size_t count,
                                             std::size_t least = shortest_part);

// Executor::evaluate() in parts, between the given places, on several threads. `executor` is one
// for this program, or null; afterwards one that may be used again, or null.
[[nodiscard]] std::optional<Failure> evaluate_parts(const Program& program,
                                                    std::span<const std::size_t> places,
                                                    Executor::Columns columns,
                                                    Executor::Outputs outputs, std::size_t threads,
                                                    std::unique_ptr<Executor>& executor);

} // namespace rtamt::discrete
