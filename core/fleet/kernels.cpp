#include "kernels.hpp"

#include "../discrete/window.hpp"
#include "../program/kernel_factory.hpp"
#include "../values/components.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

namespace rtamt::fleet {

namespace {

template <class Operation>
class Unary final : public Kernel {
  public:
    using Kernel::Kernel;
    void run(const Block& block, const double* a, const double* /*b*/,
             double* out) const noexcept override {
        for (std::size_t i = 0; i < block.count; ++i)
            out[i] = Operation::of(a[i]);
    }
};

template <class Operation>
class Binary final : public Kernel {
  public:
    using Kernel::Kernel;
    void run(const Block& block, const double* a, const double* b,
             double* out) const noexcept override {
        for (std::size_t i = 0; i < block.count; ++i)
            out[i] = Operation::of(a[i], b[i]);
    }
};

// As discrete/shift.hpp.
class Shift final : public Kernel {
  public:
    Shift(std::int64_t lag, std::int64_t distance, double absent) noexcept
        : Kernel(lag, {distance == 0 ? 0 : sizeof(Head),
                       static_cast<std::size_t>(distance) * sizeof(double)}),
          distance_(static_cast<std::uint64_t>(distance)), absent_(absent) {}

    void run(const Block& block, const double* a, const double* /*b*/,
             double* out) const noexcept override {
        if (distance_ == 0) {
            each(
                block, [=](std::size_t i) { out[i] = a[i]; },
                [=, this](std::size_t i) { out[i] = absent_; });
            return;
        }
        for (std::size_t i = 0; i < block.count; ++i) {
            std::byte* record = block.records[i];
            prefetch(tail<double>(record) + head<Head>(record).next);
        }
        each(
            block,
            [=, this, &block](std::size_t i) {
                auto& at = head<Head>(block.records[i]);
                double& cell = tail<double>(block.records[i])[at.next];
                const double here = a[i];
                out[i] = at.full != 0 ? cell : absent_;
                cell = here;
                if (++at.next == distance_) at = {0, 1};
            },
            [=, this](std::size_t i) { out[i] = absent_; });
    }

    void start(std::byte* record, std::int64_t /*pushes*/) const noexcept override {
        if (distance_ != 0) head<Head>(record) = {0, 0};
    }

    [[nodiscard]] bool accept(std::byte* record) const noexcept override {
        if (distance_ == 0) return true;
        const auto& at = head<Head>(record);
        return at.next < distance_ && at.full <= 1;
    }

    [[nodiscard]] std::int64_t look_back() const noexcept override {
        return static_cast<std::int64_t>(distance_);
    }

  private:
    struct Head {
        std::uint64_t next;
        std::uint64_t full;
    };
    std::uint64_t distance_;
    double absent_;
};

// As discrete/running.hpp.
template <class Algebra>
class Running final : public Kernel {
  public:
    explicit Running(std::int64_t lag) noexcept : Kernel(lag, {sizeof(double), 0}) {}

    void run(const Block& block, const double* a, const double* /*b*/,
             double* out) const noexcept override {
        each(
            block,
            [=, this, &block](std::size_t i) {
                auto& total = head<double>(block.records[i]);
                total = Algebra::join(a[i], total);
                out[i] = total;
            },
            [=, this, &block](std::size_t i) { out[i] = head<double>(block.records[i]); });
    }

    void start(std::byte* record, std::int64_t /*pushes*/) const noexcept override {
        head<double>(record) = Algebra::identity;
    }
    [[nodiscard]] bool accept(std::byte* record) const noexcept override {
        return !std::isnan(head<double>(record));
    }
    [[nodiscard]] std::int64_t look_back() const noexcept override { return endless; }
};

// As discrete/since.hpp.
class Since final : public Kernel {
  public:
    explicit Since(std::int64_t lag) noexcept : Kernel(lag, {sizeof(double), 0}) {}

    void run(const Block& block, const double* a, const double* b,
             double* out) const noexcept override {
        each(
            block,
            [=, this, &block](std::size_t i) {
                auto& since = head<double>(block.records[i]);
                since = Real::join(b[i], Real::meet(a[i], since));
                out[i] = since;
            },
            [=, this, &block](std::size_t i) { out[i] = head<double>(block.records[i]); });
    }

    void start(std::byte* record, std::int64_t /*pushes*/) const noexcept override {
        head<double>(record) = Real::bottom;
    }
    [[nodiscard]] bool accept(std::byte* record) const noexcept override {
        return !std::isnan(head<double>(record));
    }
    [[nodiscard]] std::int64_t look_back() const noexcept override { return endless; }
};

// One step of discrete/two_stack.hpp.
template <Monoid M>
class Sliding final : public Kernel {
  public:
    using Element = typename M::Element;

    Sliding(std::int64_t lag, std::int64_t width) noexcept
        : Kernel(lag, {sizeof(Head), static_cast<std::size_t>(width) * sizeof(Element)}),
          width_(static_cast<std::uint32_t>(width)) {}

    void run(const Block& block, const double* a, const double* b,
             double* out) const noexcept override {
        for (std::size_t i = 0; i < block.count; ++i) {
            std::byte* record = block.records[i];
            const std::uint32_t fill = head<Head>(record).fill;
            prefetch(tail<Element>(record) + (fill == width_ ? 0 : fill));
        }
        each(
            block,
            [=, this, &block](std::size_t i) {
                auto& at = head<Head>(block.records[i]);
                auto* ring = tail<Element>(block.records[i]);
                if (at.fill == width_) {
                    discrete::Stretch<M>::flip(ring, width_);
                    at = {M::identity, 0, 1};
                }
                const Element here = element(a, b, i);
                const Element back = M::append(at.back, here);
                const std::uint32_t next = at.fill + 1;
                out[i] =
                    at.front != 0 && next < width_ ? M::result(ring[next], back) : M::result(back);
                ring[at.fill] = here;
                at.back = back;
                at.fill = next;
            },
            [=](std::size_t i) { out[i] = M::result(M::identity); });
    }

    // The place in the stretch is that of a window that has seen all operands: sums depend on it.
    void start(std::byte* record, std::int64_t pushes) const noexcept override {
        const auto fill = static_cast<std::uint32_t>(pushes % width_);
        head<Head>(record) = {M::identity, fill, pushes >= std::int64_t{width_} ? 1U : 0U};
        if (pushes > 0) std::fill_n(tail<Element>(record), width_, M::identity);
    }

    [[nodiscard]] bool accept(std::byte* record) const noexcept override {
        const auto& at = head<Head>(record);
        return at.fill <= width_ && at.front <= 1;
    }

    [[nodiscard]] std::int64_t look_back() const noexcept override { return width_ - 1; }

  private:
    struct Head {
        Element back;
        std::uint32_t fill;
        std::uint32_t front;
    };
    std::uint32_t width_;

    [[nodiscard]] static Element element(const double* a, const double* b, std::size_t i) noexcept {
        if constexpr (M::binary) {
            return M::element(a[i], b[i]);
        } else {
            return M::element(a[i]);
        }
    }
};

// The c-th value of a window in order: the ring of its values, and the same sorted.
//
// Cost: O(log w) and a move of w values at most.
template <bool least>
class Rank final : public Kernel {
  public:
    Rank(std::int64_t lag, std::int64_t width, double order) noexcept
        : Kernel(lag, {sizeof(Head), static_cast<std::size_t>(width) * 2 * sizeof(double)}),
          width_(static_cast<std::uint32_t>(width)), order_(static_cast<std::uint64_t>(order)) {}

    void run(const Block& block, const double* a, const double* /*b*/,
             double* out) const noexcept override {
        for (std::size_t i = 0; i < block.count; ++i) {
            std::byte* record = block.records[i];
            prefetch(tail<double>(record) + head<Head>(record).next);
            prefetch(tail<double>(record) + width_);
        }
        each(
            block,
            [=, this, &block](std::size_t i) {
                auto& at = head<Head>(block.records[i]);
                auto* ring = tail<double>(block.records[i]);
                double* sorted = ring + width_;
                if (at.used == width_) {
                    remove(sorted, at.used, ring[at.next]);
                } else {
                    ++at.used;
                }
                insert(sorted, at.used, a[i]);
                ring[at.next] = a[i];
                at.next = at.next + 1 == width_ ? 0 : at.next + 1;
                out[i] = order_ <= at.used ? sorted[order_ - 1] : outside;
            },
            [=](std::size_t i) { out[i] = outside; });
    }

    void start(std::byte* record, std::int64_t /*pushes*/) const noexcept override {
        head<Head>(record) = {0, 0};
    }

    [[nodiscard]] bool accept(std::byte* record) const noexcept override {
        const auto& at = head<Head>(record);
        if (at.next >= width_ || at.used > width_) return false;
        if (at.used != width_ && at.used != at.next) return false;
        auto* ring = tail<double>(record);
        if (std::any_of(ring, ring + at.used, [](double x) { return std::isnan(x); })) return false;
        std::copy_n(ring, at.used, ring + width_);
        std::sort(ring + width_, ring + width_ + at.used, before);
        return true;
    }

    [[nodiscard]] std::int64_t look_back() const noexcept override { return width_ - 1; }

  private:
    using Keys = Key<least>;
    static constexpr double outside = least ? Real::top : Real::bottom;
    struct Head {
        std::uint32_t next;
        std::uint32_t used;
    };
    std::uint32_t width_;
    std::uint64_t order_;

    [[nodiscard]] static bool before(double a, double b) noexcept {
        return Keys::of(a) < Keys::of(b);
    }
    static void remove(double* sorted, std::size_t count, double old) noexcept {
        double* at = std::lower_bound(sorted, sorted + count, old, before);
        std::copy(at + 1, sorted + count, at);
    }
    // Among count - 1 values.
    static void insert(double* sorted, std::size_t count, double fresh) noexcept {
        double* end = sorted + count - 1;
        double* at = std::upper_bound(sorted, end, fresh, before);
        std::copy_backward(at, end, end + 1);
        *at = fresh;
    }
};

struct Make {
    using Pointer = std::unique_ptr<Kernel>;
    const Instruction& at;
    std::int64_t lag; // of the operands

    template <class Operation>
    [[nodiscard]] Pointer unary() const {
        return std::make_unique<Unary<Operation>>(lag);
    }
    template <class Operation>
    [[nodiscard]] Pointer binary() const {
        return std::make_unique<Binary<Operation>>(lag);
    }
    template <ValueDomain D>
    [[nodiscard]] Pointer shift() const {
        return std::make_unique<Shift>(lag, at.n, at.x);
    }
    template <class Algebra>
    [[nodiscard]] Pointer slide() const {
        return std::make_unique<Sliding<Joined<Algebra>>>(lag, at.n);
    }
    template <class Algebra>
    [[nodiscard]] Pointer running() const {
        return std::make_unique<Running<Algebra>>(lag);
    }
    template <ValueDomain D>
    [[nodiscard]] Pointer since() const {
        return std::make_unique<Since>(lag);
    }
    template <ValueDomain D>
    [[nodiscard]] Pointer until() const {
        return std::make_unique<Sliding<UntilSteps<D>>>(lag, at.n);
    }
    template <ValueDomain D, bool least>
    [[nodiscard]] Pointer rank() const {
        return std::make_unique<Rank<least>>(lag, at.n, at.x);
    }
};

} // namespace

std::unique_ptr<Kernel> make_kernel_of(const Program& program, const Instruction& instruction,
                                       Sort sort) {
    return make_kernel<Real>(instruction.opcode, sort,
                             Make{instruction, program.operand_lag(instruction)});
}

} // namespace rtamt::fleet
