// Extremum over the last w slots: bounded once, historically, eventually, always; and their sum.
//
// The two stacks of two_stack.hpp. For real numbers the loops are unrolled by four, because a chain
// of dependent comparisons is what would take the time, and where there are vectors of four
// doubles they are used (wide_stretch.hpp). Runs longer than a narrow window need no stacks
// (narrow_window.hpp).
#pragma once

#include "../values/real.hpp"
#include "lane_stretch.hpp"
#include "narrow_window.hpp"
#include "two_stack.hpp"
#include "wide_stretch.hpp"

namespace rtamt::discrete {

template <class Algebra>
using Slide = Sliding<Joined<Algebra>>;

template <class Algebra>
    requires(std::same_as<typename Algebra::Domain, Real> && Algebra::associative)
struct Stretch<Joined<Algebra>> {
    using In = Operands<Joined<Algebra>>;
    using Narrow = NarrowWindow<Algebra>;

    static void flip(double* ring, std::size_t width) noexcept {
        double tail = Algebra::identity;
        std::size_t i = width;
#ifdef RTAMT_WIDE
        if (width >= Wide::least && wide_vectors) {
            for (; i % Wide::lanes != 0; --i) {
                tail = Algebra::join(ring[i - 1], tail);
                ring[i - 1] = tail;
            }
            Wide::flip(ring, i, tail);
            return;
        }
#endif
        for (; i >= 4; i -= 4) {
            double* cell = ring + (i - 4);
            const double last = Algebra::join(cell[2], cell[3]);
            const double three = Algebra::join(cell[1], last);
            // Not of cell[0] with cell[1] first: the same comparisons twice become branches.
            const double four = Algebra::join(cell[0], three);
            cell[3] = Algebra::join(cell[3], tail);
            cell[2] = Algebra::join(last, tail);
            cell[1] = Algebra::join(three, tail);
            tail = Algebra::join(four, tail);
            cell[0] = tail;
        }
        for (; i > 0; --i) {
            tail = Algebra::join(ring[i - 1], tail);
            ring[i - 1] = tail;
        }
    }

    [[nodiscard]] static double grow(In operands, double* cells, double back, double* out,
                                     std::size_t count) noexcept {
        const double* in = operands.a;
        std::size_t i = 0;
#ifdef RTAMT_WIDE
        if (count >= Wide::least && wide_vectors) {
            back = Wide::grow(in, cells, back, out, count);
            i = count / Wide::lanes * Wide::lanes;
        }
#endif
        copy_values(in + i, count - i, cells + i);
        for (; i + 4 <= count; i += 4) {
            const double first = Algebra::join(in[i], in[i + 1]);
            const double last = Algebra::join(in[i + 2], in[i + 3]);
            out[i] = Algebra::join(in[i], back);
            out[i + 1] = Algebra::join(first, back);
            out[i + 2] = Algebra::join(in[i + 2], out[i + 1]);
            back = Algebra::join(Algebra::join(first, last), back);
            out[i + 3] = back;
        }
        for (; i < count; ++i) {
            back = Algebra::join(in[i], back);
            out[i] = back;
        }
        return back;
    }

    [[nodiscard]] static double slide(In operands, double* cells, double back, double* out,
                                      std::size_t count) noexcept {
        const double* in = operands.a;
        std::size_t i = 0;
#ifdef RTAMT_WIDE
        if (count >= Wide::least && wide_vectors) {
            back = Wide::slide(in, cells, back, out, count);
            i = count / Wide::lanes * Wide::lanes;
        }
#endif
        for (; i + 4 <= count; i += 4) {
            const double first = Algebra::join(in[i], in[i + 1]);
            const double last = Algebra::join(in[i + 2], in[i + 3]);
            const double back0 = Algebra::join(in[i], back);
            const double back1 = Algebra::join(first, back);
            const double back2 = Algebra::join(in[i + 2], back1);
            back = Algebra::join(Algebra::join(first, last), back);
            out[i] = Algebra::join(back0, cells[i + 1]);
            out[i + 1] = Algebra::join(back1, cells[i + 2]);
            out[i + 2] = Algebra::join(back2, cells[i + 3]);
            out[i + 3] = Algebra::join(back, cells[i + 4]);
            cells[i] = in[i];
            cells[i + 1] = in[i + 1];
            cells[i + 2] = in[i + 2];
            cells[i + 3] = in[i + 3];
        }
        for (; i < count; ++i) {
            back = Algebra::join(in[i], back);
            out[i] = Algebra::join(back, cells[i + 1]);
            cells[i] = in[i];
        }
        return back;
    }

  private:
#ifdef RTAMT_WIDE
    using Wide = WideStretch<Algebra>;
#endif
};

} // namespace rtamt::discrete
