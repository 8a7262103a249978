// Windows and delays of truth values, +inf or -inf, for real numbers: a bit a slot, or none.
//
// A window of the greatest or least value needs no ring: whether it contains the deciding value
// depends on the slots since the last one. Until is decided by the first slot of its window where
// psi holds or phi does not; when such a slot comes, all slots before it that are still open get
// its value, so that a bit a slot is left. Narrow windows keep numbers, whose loops are faster.
//
// Cost: a few operations a sample; of until, one a word of 64 open slots when these are decided.
// Memory: w / 8 bytes for a delay of w slots or until over w slots, touched as far as the trace has
// come; one number for a window.
#pragma once

#include "../values/algebra.hpp"
#include "copy.hpp"
#include "journal.hpp"
#include "kernel.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace rtamt::discrete {

// From this width on, truth values are kept as bits.
inline constexpr std::int64_t least_packed = 1024;

// A ring of bits: 1 where a value is +inf. Ranges do not wrap round.
class TruthBits {
  public:
    using Word = std::uint64_t;
    static constexpr std::size_t width = 64;

    explicit TruthBits(Word* words) noexcept : words_(words) {}

    [[nodiscard]] static constexpr std::size_t words(std::size_t bits) noexcept {
        return bits / width + static_cast<std::size_t>(bits % width != 0);
    }

    [[nodiscard]] bool at(std::size_t cell) const noexcept {
        return ((words_[cell / width] >> (cell % width)) & 1U) != 0;
    }

    void read(std::size_t begin, std::size_t count, double* out) const noexcept {
        for_words(begin, count, [&](std::size_t word, std::size_t shift, std::size_t bits) {
            const Word here = words_[word] >> shift;
            for (std::size_t i = 0; i < bits; ++i)
                out[i] = number(((here >> i) & 1U) != 0);
            out += bits;
        });
    }

    void write(std::size_t begin, std::size_t count, const double* values) noexcept {
        for_words(begin, count, [&](std::size_t word, std::size_t shift, std::size_t bits) {
            Word here = 0;
            for (std::size_t i = 0; i < bits; ++i)
                here |= Word{values[i] > 0} << i;
            replace(word, shift, bits, here);
            values += bits;
        });
    }

    void fill(std::size_t begin, std::size_t count, bool value) noexcept {
        for_words(begin, count, [&](std::size_t word, std::size_t shift, std::size_t bits) {
            replace(word, shift, bits, value ? ~Word{0} : Word{0});
        });
    }

    // Keeps the words of a range of cells.
    void save(Journal<Word>& journal, std::size_t begin, std::size_t count) const noexcept {
        const std::size_t first = begin / width;
        journal.save(words_, first, count == 0 ? 0 : words(begin + count) - first);
    }
    void restore(const Journal<Word>& journal) noexcept { journal.restore(words_); }

    void transfer(Snapshot& snapshot, std::size_t count) { snapshot.values(words_, words(count)); }

    [[nodiscard]] static constexpr double number(bool holds) noexcept {
        return holds ? Real::top : Real::bottom;
    }

  private:
    Word* words_;

    template <class Visit>
    static void for_words(std::size_t begin, std::size_t count, Visit&& visit) noexcept {
        for (const std::size_t end = begin + count; begin < end;) {
            const std::size_t shift = begin % width;
            const std::size_t bits = std::min(width - shift, end - begin);
            visit(begin / width, shift, bits);
            begin += bits;
        }
    }

    void replace(std::size_t word, std::size_t shift, std::size_t bits, Word value) noexcept {
        const Word mask = (~Word{0} >> (width - bits)) << shift;
        words_[word] = (words_[word] & ~mask) | ((value << shift) & mask);
    }
};

// A ring of truth values, one a slot, and what is written, kept and taken back alike.
class TruthRing : public Kernel {
  public:
    // `width` bits in whole words at `ring`, and as many at `journal`, if there is one.
    TruthRing(std::int64_t operand_lag, std::size_t width, TruthBits::Word* ring,
              TruthBits::Word* journal) noexcept
        : Kernel(operand_lag), bits_(ring), width_(width), journal_(journal) {}

    void reset() noexcept override { state_ = {}; }

    void checkpoint(std::size_t count) noexcept override {
        saved_ = state_;
        if (count <= width_ - state_.next) {
            bits_.save(journal_, state_.next, state_.full ? count : 0);
        } else {
            bits_.save(journal_, 0, filled());
        }
    }

    void rollback() noexcept override {
        state_ = saved_;
        bits_.restore(journal_);
    }

    void transfer(Snapshot& snapshot) override {
        snapshot.item(state_.next);
        snapshot.item(state_.open);
        snapshot.item(state_.full);
        snapshot.require(state_.next < width_ && state_.open <= filled());
        if (!snapshot.loading()) clear();
        bits_.transfer(snapshot, filled());
    }

  protected:
    struct State {
        std::size_t next = 0; // cell to be written next; when the ring is full, the oldest one
        std::size_t open = 0; // how many of the last slots have no value yet
        bool full = false;
    };

    [[nodiscard]] TruthBits& bits() noexcept { return bits_; }
    [[nodiscard]] State& state() noexcept { return state_; }
    [[nodiscard]] std::size_t width() const noexcept { return width_; }
    [[nodiscard]] std::size_t filled() const noexcept { return state_.full ? width_ : state_.next; }

    void advance(std::size_t count) noexcept {
        state_.next += count;
        if (state_.next == width_) {
            state_.next = 0;
            state_.full = true;
        }
    }

    // Gives the last `count` slots a value.
    void decide(std::size_t count, bool value) noexcept {
        const std::size_t here = std::min(count, state_.next);
        bits_.fill(state_.next - here, here, value);
        bits_.fill(width_ - (count - here), count - here, value);
    }

  private:
    TruthBits bits_;
    std::size_t width_;
    State state_;
    State saved_;
    Journal<TruthBits::Word> journal_;

    // What an update that was taken back may have left in cells without a value.
    void clear() noexcept {
        decide(state_.open, false);
        if (!state_.full) bits_.fill(state_.next, width_ - state_.next, false);
    }
};

// The operand `width` slots ago (shift.hpp).
class TruthShift final : public TruthRing {
  public:
    TruthShift(std::int64_t operand_lag, std::size_t width, double absent, TruthBits::Word* ring,
               TruthBits::Word* journal) noexcept
        : TruthRing(operand_lag, width, ring, journal), absent_(absent) {}

    std::size_t run(const Block& block) noexcept override {
        const Range present = block.present(lag());
        auto* out = this->out<double>();
        fill_values(out, present.begin, absent_);
        push(a<double>() + present.begin, out + present.begin, present.end - present.begin);
        push(nullptr, out + present.end, block.count - present.end);
        return defined;
    }

  private:
    double absent_;

    // Consecutive values, or null for as many absent ones.
    void push(const double* values, double* out, std::size_t count) noexcept {
        for (std::size_t done = 0; done < count;) {
            const std::size_t next = state().next;
            const std::size_t part = std::min(count - done, width() - next);
            if (state().full) {
                bits().read(next, part, out + done);
            } else {
                fill_values(out + done, part, absent_);
            }
            if (values != nullptr) {
                bits().write(next, part, values + done);
            } else {
                bits().fill(next, part, absent_ > 0);
            }
            advance(part);
            done += part;
        }
    }
};

// Until over the last `width` slots (until.hpp).
class TruthUntil final : public TruthRing {
  public:
    using TruthRing::TruthRing;

    std::size_t run(const Block& block) noexcept override {
        const Range present = block.present(lag());
        const auto* phi = a<double>();
        const auto* psi = b<double>();
        auto* out = this->out<double>();
        fill_values(out, present.begin, Real::bottom);
        for (std::size_t i = present.begin; i < present.end; ++i)
            out[i] = next(phi[i] > 0, psi[i] > 0);
        for (std::size_t i = present.end; i < block.count; ++i)
            out[i] = next(true, false); // leaves all open
        return defined;
    }

  private:
    [[nodiscard]] double next(bool phi, bool psi) noexcept {
        State& now = state();
        const bool open = phi && !psi;
        if (open) {
            now.open = std::min(now.open + 1, width());
            advance(1);
        } else {
            const std::size_t before = std::min(now.open, width() - 1);
            advance(1);
            decide(before + 1, psi);
            now.open = 0;
        }
        const std::size_t oldest = now.full ? now.next : 0;
        return TruthBits::number(now.open < filled() && bits().at(oldest));
    }
};

// The greatest or the least of the last `width` values (window.hpp).
template <class Algebra>
class TruthWindow final : public Kernel {
  public:
    TruthWindow(std::int64_t operand_lag, std::size_t width) noexcept
        : Kernel(operand_lag), width_(static_cast<std::int64_t>(width)), since_(width_),
          saved_(width_) {}

    std::size_t run(const Block& block) noexcept override {
        const Range present = block.present(lag());
        const auto* __restrict in = a<double>();
        auto* __restrict out = this->out<double>();
        fill_values(out, present.begin, Algebra::identity);
        std::int64_t since = since_;
        for (std::size_t i = present.begin; i < present.end; ++i) {
            since = in[i] == deciding ? 0 : since + 1;
            out[i] = since < width_ ? deciding : Algebra::identity;
        }
        for (std::size_t i = present.end; i < block.count; ++i)
            out[i] = ++since < width_ ? deciding : Algebra::identity;
        since_ = std::min(since, width_);
        return defined;
    }

    void reset() noexcept override { since_ = width_; }
    void checkpoint(std::size_t /*count*/) noexcept override { saved_ = since_; }
    void rollback() noexcept override { since_ = saved_; }
    void transfer(Snapshot& snapshot) override {
        snapshot.item(since_);
        snapshot.require(since_ >= 0 && since_ <= width_);
    }

  private:
    static constexpr double deciding = -Algebra::identity;

    std::int64_t width_;
    std::int64_t since_; // slots since the deciding value, at most `width_`
    std::int64_t saved_;
};

} // namespace rtamt::discrete
