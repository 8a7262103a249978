// Extremum over all time so far: unbounded once and historically.
//
// Cost: one comparison an event. Memory: one value.
#pragma once

#include "../values/algebra.hpp"
#include "kernel.hpp"

namespace rtamt::dense {

template <class Algebra>
class Running final : public Temporal<typename Algebra::Domain> {
  public:
    using Base = Temporal<typename Algebra::Domain>;
    using Value = typename Algebra::Value;

    explicit Running(std::int64_t lag) noexcept : Base(lag, Algebra::identity) {}

    std::int64_t run(std::int64_t frontier) override {
        const BasicEvents<Value> a = Kernel::a<Value>();
        auto out = this->open(a.count);
        for (std::size_t i = 0; i < a.count; ++i)
            out.put(a.times[i], Algebra::join(a.values[i], out.last));
        this->close(out, frontier);
        return never;
    }
};

} // namespace rtamt::dense
