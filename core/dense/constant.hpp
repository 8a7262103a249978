// A constant as a step function: one event, where the operands that it is combined with begin.
#pragma once

#include "kernel.hpp"

namespace rtamt::dense {

template <ValueDomain D>
class Constant final : public Temporal<D> {
  public:
    using Temporal<D>::Temporal;

    std::int64_t run(std::int64_t frontier) override {
        auto out = this->open(0);
        this->close(out, frontier);
        return never;
    }
};

} // namespace rtamt::dense
