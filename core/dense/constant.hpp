// A constant as a step function: one event, where the operands that it is combined with begin.
#pragma once

#include "kernel.hpp"

namespace rtamt::dense {

class Constant final : public Temporal {
  public:
    using Temporal::Temporal;

    std::int64_t run(std::int64_t frontier) override {
        Writer out = open(0);
        close(out, frontier);
        return never;
    }
};

} // namespace rtamt::dense
