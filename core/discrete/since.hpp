// Unbounded since, by its recursion S(t) = max(psi(t), min(phi(t), S(t-1))), S(-1) = -inf
// (O. Maler, D. Nickovic, "Monitoring properties of analog and mixed-signal circuits", 2013).
//
// Cost: two comparisons a sample. Memory: one double.
#pragma once

#include "../algebra.hpp"
#include "../cells.hpp"
#include "../kernel.hpp"

namespace rtamt::discrete {

class Since final : public Kernel {
  public:
    using Kernel::Kernel;

    std::size_t run(const Block& block) noexcept override {
        const Range present = block.present(lag());
        const double* phi = a(); // may be the same as psi
        const double* psi = b();
        double* __restrict out = this->out();
        double since = since_;
        fill_cells(out, present.begin, since);
        for (std::size_t i = present.begin; i < present.end; ++i) {
            since = Max::join(psi[i], Min::join(phi[i], since));
            out[i] = since;
        }
        fill_cells(out + present.end, block.count - present.end, since);
        since_ = since;
        return defined;
    }

    void reset() noexcept override { since_ = Max::identity; }
    void checkpoint(std::size_t /*count*/) noexcept override { saved_ = since_; }
    void rollback() noexcept override { since_ = saved_; }
    void transfer(Snapshot& snapshot) override { snapshot.item(since_); }

  private:
    double since_ = Max::identity;
    double saved_ = Max::identity;
};

} // namespace rtamt::discrete
