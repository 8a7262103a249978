// Windows and delays of truth values, +inf or -inf, for real numbers: a bit a slot, or none.
//
// A window of the greatest or least value needs no ring: whether it contains the deciding value
// depends on the slots since the last one. Until is decided by the first slot of its window where
// psi holds or phi does not; when such a slot comes, all slots before it that are still open get
// its value, so that a bit a slot is left. All compute 64 slots at a time. Narrow windows keep
// numbers, which then need little memory.
//
// Cost: one or two operations a sample; of until, one more for every 64 open slots when these are
// decided.
// Memory: w / 8 bytes for a delay of w slots or until over w slots, touched as far as the trace has
// come; one number for a window.
#pragma once

#include "copy.hpp"
#include "journal.hpp"
#include "kernel.hpp"
#include "truth_words.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace rtamt::discrete {

// From this width on, truth values are kept as bits.
inline constexpr std::int64_t least_packed = 1024;

// A ring of bits: 1 where a value is +inf. Ranges do not wrap round.
class TruthBits {
  public:
    using Word = TruthWord;
    static constexpr std::size_t width = truth_word_bits;

    explicit TruthBits(Word* words) noexcept : words_(words) {}

    [[nodiscard]] static constexpr std::size_t words(std::size_t bits) noexcept {
        return bits / width + static_cast<std::size_t>(bits % width != 0);
    }

    [[nodiscard]] bool at(std::size_t cell) const noexcept {
        return ((words_[cell / width] >> (cell % width)) & 1U) != 0;
    }

    void read(std::size_t begin, std::size_t count, double* out) const noexcept {
        for_words(begin, count, [&](std::size_t word, std::size_t shift, std::size_t bits) {
            unpack_truth(words_[word] >> shift, bits, out);
            out += bits;
        });
    }

    void write(std::size_t begin, std::size_t count, const double* values) noexcept {
        for_words(begin, count, [&](std::size_t word, std::size_t shift, std::size_t bits) {
            replace(word, shift, bits, pack_truth(values, bits));
            values += bits;
        });
    }

    void fill(std::size_t begin, std::size_t count, bool value) noexcept {
        for_words(begin, count, [&](std::size_t word, std::size_t shift, std::size_t bits) {
            replace(word, shift, bits, value ? ~Word{0} : Word{0});
        });
    }

    // The cells from one on to the end of its word, the first lowest; 0 above.
    [[nodiscard]] Word rest(std::size_t cell) const noexcept {
        return words_[cell / width] >> (cell % width);
    }
    // Writes at most as many.
    void write_rest(std::size_t cell, std::size_t count, Word values) noexcept {
        replace(cell / width, cell % width, count, values);
    }

    // Keeps the words of a range of cells.
    void save(Journal<Word>& journal, std::size_t begin, std::size_t count) const noexcept {
        const std::size_t first = begin / width;
        journal.save(words_, first, count == 0 ? 0 : words(begin + count) - first);
    }
    void restore(const Journal<Word>& journal) noexcept { journal.restore(words_); }

    void transfer(Snapshot& snapshot, std::size_t count) { snapshot.values(words_, words(count)); }

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
        const Word mask = lowest_bits(bits) << shift;
        words_[word] = (words_[word] & ~mask) | ((value << shift) & mask);
    }
};

// A ring of truth values, one a slot, and the shared logic to write, keep and roll back.
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

// Until over the last `width` slots, which are more than a word has (until.hpp).
class TruthUntil final : public TruthRing {
  public:
    using TruthRing::TruthRing;

    std::size_t run(const Block& block) noexcept override {
        const Range present = block.present(lag());
        const auto* phi = a<double>();
        const auto* psi = b<double>();
        auto* out = this->out<double>();
        fill_values(out, present.begin, Real::bottom);
        each_part(present.begin, present.end, [&](std::size_t i, std::size_t count) {
            push(pack_truth(phi + i, count), pack_truth(psi + i, count), count, out + i);
        });
        each_part(present.end, block.count, [&](std::size_t i, std::size_t count) {
            push(lowest_bits(count), 0, count, out + i); // leaves all open
        });
        return defined;
    }

  private:
    using Word = TruthWord;

    // Parts whose cells lie in one word.
    template <class Visit>
    void each_part(std::size_t begin, std::size_t end, Visit&& visit) noexcept {
        while (begin < end) {
            const std::size_t next = state().next;
            const std::size_t count =
                std::min({end - begin, width() - next, TruthBits::width - next % TruthBits::width});
            visit(begin, count);
            begin += count;
        }
    }

    // The slots of a part.
    void push(Word phi, Word psi, std::size_t count, double* out) noexcept {
        State& now = state();
        const Word part = lowest_bits(count);
        const Word open = phi & ~psi;
        const Word decided = part & ~open;
        const auto first = static_cast<std::size_t>(std::countr_zero(decided));
        const bool value = decided != 0 && ((psi >> first) & 1U) != 0;
        unpack_truth(oldest(count, first, value) & part, count, out);
        if (decided == 0) {
            now.open = std::min(now.open + count, width());
        } else {
            decide(now.open, value);
            bits().write_rest(now.next, count, settled(psi, open));
            now.open = count - static_cast<std::size_t>(std::bit_width(decided));
        }
        advance(count);
    }

    // What the window of each slot of a part begins with; the slots that are open before the part
    // get a value by its slot `first`.
    [[nodiscard]] Word oldest(std::size_t count, std::size_t first, bool value) noexcept {
        const State& now = state();
        const Word later = value && first < count ? ~Word{0} << first : 0;
        if (!now.full) {
            if (now.open == now.next) return later;
            return bits().at(0) ? ~Word{0} : 0;
        }
        // The cell after that of each slot: the last one may lie in another word.
        const std::size_t last = now.next + count == width() ? 0 : now.next + count;
        Word word = (bits().rest(now.next) >> 1U) & ~(Word{1} << (count - 1));
        word |= Word{bits().at(last)} << (count - 1);
        const std::size_t closed = width() - 1 - std::min(now.open, width() - 1);
        if (closed >= count) return word;
        const Word undecided = ~Word{0} << closed;
        return (word & ~undecided) | (later & undecided);
    }

    // Gives open slots the value of the next one that is not.
    [[nodiscard]] static Word settled(Word values, Word open) noexcept {
        for (unsigned distance = 1; distance < TruthBits::width; distance *= 2) {
            values |= open & (values >> distance);
            open &= open >> distance;
        }
        return values;
    }
};

// The greatest or the least of the last `width` values (window.hpp).
template <class Algebra>
class TruthWindow final : public Kernel {
  public:
    TruthWindow(std::int64_t operand_lag, std::size_t width) noexcept
        : Kernel(operand_lag), width_(width), since_(width), saved_(width) {}

    std::size_t run(const Block& block) noexcept override {
        const Range present = block.present(lag());
        const auto* __restrict in = a<double>();
        auto* __restrict out = this->out<double>();
        fill_values(out, present.begin, Algebra::identity);
        // No window leaves a deciding value of the same part.
        const std::size_t most = std::min(width_, truth_word_bits);
        for (std::size_t i = present.begin; i < present.end;) {
            const std::size_t count = std::min(most, present.end - i);
            push(pack_truth(in + i, count), count, out + i);
            i += count;
        }
        expire(block.count - present.end, out + present.end);
        return defined;
    }

    void reset() noexcept override { since_ = width_; }
    void checkpoint(std::size_t /*count*/) noexcept override { saved_ = since_; }
    void rollback() noexcept override { since_ = saved_; }
    void transfer(Snapshot& snapshot) override {
        snapshot.item(since_);
        snapshot.require(since_ <= width_);
    }

  private:
    static constexpr double deciding = -Algebra::identity;

    std::size_t width_;
    std::size_t since_; // slots since the deciding value, at most `width_`
    std::size_t saved_;

    // The slots of a part.
    void push(TruthWord values, std::size_t count, double* out) noexcept {
        const TruthWord decisive = (deciding > 0 ? values : ~values) & lowest_bits(count);
        if (decisive == 0) {
            expire(count, out);
            return;
        }
        const auto first = static_cast<std::size_t>(std::countr_zero(decisive));
        expire(first, out);
        fill_values(out + first, count - first, deciding);
        since_ = count - static_cast<std::size_t>(std::bit_width(decisive));
    }

    // Slots without the deciding value.
    void expire(std::size_t count, double* out) noexcept {
        const std::size_t left = width_ - since_; // slots whose windows contain it, and one
        const std::size_t held = std::min(count, left == 0 ? 0 : left - 1);
        fill_values(out, held, deciding);
        fill_values(out + held, count - held, Algebra::identity);
        since_ = std::min(since_ + count, width_);
    }
};

} // namespace rtamt::discrete
