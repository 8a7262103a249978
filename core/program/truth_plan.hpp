// A plan whose values are truth values, in two: the numbers up to the predicates, and what joins
// the predicates, which needs a bit for each value.
//
// Cost: two passes over the programs. Memory: a copy of them.
#pragma once

#include "stages.hpp"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace rtamt {

struct TruthPlan {
    Program numbers;           // of the variables; an output for each predicate
    std::vector<Stage> joined; // of the predicates, as if they were the variables
    bool pointwise = false;    // whether each predicate reads samples of its own instant alone
};

// Nothing where an output is not a truth value by its form, or where a number is computed from a
// scan.
[[nodiscard]] std::optional<TruthPlan> truth_plan(std::span<const Stage> stages,
                                                  std::size_t variables);

} // namespace rtamt
