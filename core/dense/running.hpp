// Extremum over all time so far: unbounded once and historically.
//
// Cost: one comparison an event. Memory: one double.
#pragma once

#include "../algebra.hpp"
#include "kernel.hpp"

namespace rtamt::dense {

template <class Algebra>
class Running final : public Temporal {
  public:
    explicit Running(std::int64_t lag) noexcept : Temporal(lag, Algebra::identity) {}

    std::int64_t run(std::int64_t frontier) override {
        const Events a = this->a();
        Writer out = open(a.count);
        for (std::size_t i = 0; i < a.count; ++i)
            out.put(a.times[i], Algebra::join(a.values[i], out.last));
        close(out, frontier);
        return never;
    }
};

} // namespace rtamt::dense
