// Propagation of changes to a rank in a window: the values in the window are kept in
// order while it passes over the ticks that can have changed.
#include "../values/components.hpp"
#include "../values/weighted.hpp"
#include "bounds_engine.hpp"

#include <algorithm>

namespace rtamt::early {

namespace {

// The value of a rank in a window that moves; `up` counts from the greatest.
template <bool up>
class Ranking {
  public:
    Ranking(const Runs& operand, Tick low, Tick high, Tick order, Tick t)
        : operand_(operand), low_(low), high_(high), order_(order), t_(t) {
        Tick begin = std::max<Tick>(0, t + low);
        while (begin <= t + high) {
            const Run run = operand.at(begin);
            const Tick end = std::min(run.end, t + high);
            tree_.insert(name(run), end - begin + 1);
            begin = end + 1;
        }
    }

    [[nodiscard]] double value() const noexcept {
        const auto place = tree_.find(order_);
        return place ? Keys::value(place->name.key) : (up ? -infinity : infinity);
    }

    // Moves on to the next tick at which the value can be another one, or behind `last`.
    [[nodiscard]] Tick next(Tick last) {
        Tick steps = last - t_ + 1;
        const Tick tail = t_ + low_;
        const Tick head = t_ + high_ + 1;
        const bool leaves = tail >= 0;
        const bool enters = head >= 0;
        const Run old = operand_.at(std::max<Tick>(tail, 0));
        const Run fresh = operand_.at(std::max<Tick>(head, 0));
        steps = std::min(steps, leaves ? old.end - tail + 1 : -tail);
        steps = std::min(steps, enters ? fresh.end - head + 1 : -head);
        if (!enters || (leaves && old.begin == fresh.begin)) {
            t_ += steps;
            return t_;
        }
        if (fresh.begin == head || head == 0) tree_.insert(name(fresh), 0);
        steps = std::min(steps, change(name(fresh), name(old), leaves));
        tree_.add(name(fresh), steps);
        if (leaves) {
            tree_.add(name(old), -steps);
            if (tail + steps > old.end) tree_.erase(name(old));
        }
        t_ += steps;
        return t_;
    }

  private:
    using Keys = Key<!up>;
    using Name = Weighted::Name;

    const Runs& operand_;
    Tick low_;
    Tick high_;
    Tick order_;
    Tick t_;
    Weighted tree_;

    [[nodiscard]] static Name name(const Run& run) noexcept {
        return {Keys::of(run.value), static_cast<std::uint64_t>(run.begin)};
    }

    [[nodiscard]] Tick change(const Name& gains, const Name& loses, bool leaves) const noexcept {
        const auto place = tree_.find(order_);
        if (!place) return leaves ? forever : order_ - tree_.total();
        const int before =
            static_cast<int>(gains < place->name) - static_cast<int>(leaves && loses < place->name);
        const int upto = static_cast<int>(gains <= place->name) -
                         static_cast<int>(leaves && loses <= place->name);
        Tick steps = forever;
        if (before > 0) steps = order_ - place->before;
        if (upto < 0) steps = std::min(steps, place->upto - order_ + 1);
        return steps;
    }
};

} // namespace

// Every tick whose window meets a piece is looked at again.
void BoundsEngine::rank(std::uint32_t index, int reg, bool up) {
    const Node& own = node(index);
    State& state = nodes_[index];
    const Runs& operand = runs(own.a, reg);
    const auto order = static_cast<Tick>(own.steps.front().x);
    for (const Piece& piece : new_data(own.a, reg)) {
        const auto follow = [&](auto&& ranking, Tick t, Tick last) {
            while (t <= last) {
                const double value = ranking.value();
                const Tick next = ranking.next(last);
                lift(state, reg, t, next - 1, value);
                t = next;
            }
        };
        const Tick t = std::max(state.from, plus(piece.l, -own.high));
        // The value is constant from the last run of the operand on.
        const Run rest = operand.at(forever);
        const Tick tail = std::max(t, plus(rest.begin, -own.low));
        const Tick far = plus(piece.r, -own.low);
        const Tick last = std::min(far, tail);
        if (t >= forever || t > far) continue;
        if (up) {
            follow(Ranking<true>(operand, own.low, own.high, order, t), t, last);
        } else {
            follow(Ranking<false>(operand, own.low, own.high, order, t), t, last);
        }
        lift(state, reg, tail, far, rest.value);
    }
}

} // namespace rtamt::early
