// Extrema over the last w samples, for narrow windows and runs of samples that are longer.
//
// Four copies of the samples, each shifted by one, are joined; then four copies of the result, each
// shifted by four, and so on until the reach is w. No sample waits for the one before it.
//
// Cost: three comparisons for each factor of four in w, in vectors. Memory: a block on the stack.
#pragma once

#include "../values/vectors.hpp"
#include "copy.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace rtamt::discrete {

template <class Algebra>
class NarrowWindow {
  public:
    // Wider windows cost less in two stacks.
    static constexpr std::size_t widest = 64;

    // NOLINTNEXTLINE(*-pro-type-member-init): every value is written before it is read
    explicit NarrowWindow(std::size_t width) noexcept : width_(width) {}

    // Where the w - 1 elements before the first are to be stored, in the order of time.
    [[nodiscard]] double* before() noexcept { return samples_.data(); }

    void run(const double* in, double* out, std::size_t count) noexcept {
        for (std::size_t done = 0; done < count; done += piece) {
            const std::size_t part = std::min(piece, count - done);
            if (done != 0) copy_values(in + done - (width_ - 1), width_ - 1, before());
            copy_values(in + done, part, before() + (width_ - 1));
            join(out + done, part);
        }
    }

  private:
    static constexpr std::size_t piece = 256;

    struct Join {
        RTAMT_INLINE static void over(const double* __restrict in, std::size_t second,
                                      std::size_t third, std::size_t fourth, double* __restrict out,
                                      std::size_t count) noexcept {
            const double* b = in + second;
            const double* c = in + third;
            const double* d = in + fourth;
            for (std::size_t i = 0; i < count; ++i)
                out[i] = Algebra::join(Algebra::join(in[i], b[i]), Algebra::join(c[i], d[i]));
        }
    };

    std::size_t width_;
    std::array<double, widest - 1 + piece> samples_;
    std::array<double, widest - 1 + piece> joined_;

    void join(double* out, std::size_t count) noexcept {
        const double* in = samples_.data();
        double* next = joined_.data();
        std::size_t reach = 1; // how many samples, from i on, in[i] stands for
        for (; 4 * reach < width_; reach *= 4) {
            const std::size_t values = count + width_ - 4 * reach;
            vectorised<Join>(values, in, reach, 2 * reach, 3 * reach, next, values);
            in = next;
            next = next == joined_.data() ? samples_.data() : joined_.data();
        }
        const std::size_t last = width_ - reach;
        vectorised<Join>(count, in, std::min(reach, last), std::min(2 * reach, last), last, out,
                         count);
    }
};

} // namespace rtamt::discrete
