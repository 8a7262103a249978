// Extremum over all slots so far: unbounded once and historically.
//
// Cost: one comparison a sample. Memory: one double.
#pragma once

#include "../algebra.hpp"
#include "../cells.hpp"
#include "../kernel.hpp"

namespace rtamt::discrete {

template <class Algebra>
class Running final : public Kernel {
  public:
    using Kernel::Kernel;

    std::size_t run(const Block& block) noexcept override {
        const Range present = block.present(lag());
        const double* __restrict a = this->a();
        double* __restrict out = this->out();
        double extremum = extremum_;
        fill_cells(out, present.begin, extremum);
        for (std::size_t i = present.begin; i < present.end; ++i) {
            extremum = Algebra::join(a[i], extremum);
            out[i] = extremum;
        }
        fill_cells(out + present.end, block.count - present.end, extremum);
        extremum_ = extremum;
        return defined;
    }

    void reset() noexcept override { extremum_ = Algebra::identity; }
    void checkpoint(std::size_t /*count*/) noexcept override { saved_ = extremum_; }
    void rollback() noexcept override { extremum_ = saved_; }
    void transfer(Snapshot& snapshot) override { snapshot.item(extremum_); }

  private:
    double extremum_ = Algebra::identity;
    double saved_ = Algebra::identity;
};

} // namespace rtamt::discrete
