#include "discrete/wide_stretch.hpp"

#include "check.hpp"
#include "oracle.hpp"

#ifdef RTAMT_WIDE

using oracle::Signal;
using rtamt::Max;
using rtamt::Min;
using rtamt::discrete::WideStretch;

namespace {

template <class Algebra>
void check_stretch(std::size_t count, oracle::Random& random) {
    using Wide = WideStretch<Algebra>;
    const std::size_t whole = count / Wide::lanes * Wide::lanes;
    const Signal in = random.signal(count);
    const Signal older = random.signal(count + 1);
    const double back = random.number(0);

    Signal totals(whole);
    double total = back;
    for (std::size_t i = 0; i < whole; ++i)
        totals[i] = total = Algebra::join(in[i], total);
    Signal cells(whole);
    Signal out(whole);
    CHECK(Wide::grow(in.data(), cells.data(), back, out.data(), count) == total);
    CHECK(out == totals);
    CHECK(cells == Signal(in.begin(), in.begin() + static_cast<std::ptrdiff_t>(whole)));

    Signal joined(whole);
    for (std::size_t i = 0; i < whole; ++i)
        joined[i] = Algebra::join(totals[i], older[i + 1]);
    cells = older;
    CHECK(Wide::slide(in.data(), cells.data(), back, out.data(), count) == total);
    CHECK(out == joined);
    CHECK(
        std::equal(cells.begin(), cells.begin() + static_cast<std::ptrdiff_t>(whole), in.begin()));

    Signal suffixes(whole);
    total = back;
    for (std::size_t i = whole; i-- > 0;)
        suffixes[i] = total = Algebra::join(in[i], total);
    cells.assign(in.begin(), in.begin() + static_cast<std::ptrdiff_t>(whole));
    Wide::flip(cells.data(), whole, back);
    CHECK(cells == suffixes);
}

} // namespace

TEST_CASE("loops in vectors are their definition for any number of samples") {
    if (!rtamt::wide_vectors) return;
    oracle::Random random(1);
    for (std::size_t count = 0; count < 70; ++count) {
        check_stretch<Max>(count, random);
        check_stretch<Min>(count, random);
    }
}

#endif
