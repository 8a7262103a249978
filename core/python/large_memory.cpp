#include "large_memory.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <mutex>
#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace rtamt::python {

namespace {

using Piece = LargeMemory::Piece;

constexpr std::size_t huge = std::size_t{2} << 20U; // bytes of a huge page
constexpr std::size_t page = std::size_t{4} << 10U;

// Bytes that are kept for reuse: more where the system can take them back.
#ifdef MADV_FREE
constexpr std::size_t most_kept = std::size_t{128} << 20U;
#else
constexpr std::size_t most_kept = std::size_t{32} << 20U;
#endif

[[nodiscard]] std::align_val_t alignment(std::size_t size) noexcept {
    return static_cast<std::align_val_t>(size >= huge ? huge : page);
}

[[nodiscard]] Piece allocated(std::size_t bytes) {
    const std::size_t unit = bytes >= huge ? huge : page;
    const std::size_t size = (bytes + unit - 1) / unit * unit;
    if (size < bytes) throw std::bad_alloc();
    const Piece piece{::operator new(size, alignment(size)), size};
#ifdef MADV_HUGEPAGE
    if (size >= huge) (void)::madvise(piece.memory, size, MADV_HUGEPAGE); // else small pages
#endif
    return piece;
}

void release(const Piece& piece) noexcept {
    ::operator delete(piece.memory, alignment(piece.size));
}

// Pieces that were freed, the last one at the end.
class Spare {
  public:
    // The smallest piece that is large enough and not much larger, if there is one.
    [[nodiscard]] Piece take(std::size_t bytes) noexcept {
        const std::scoped_lock lock(mutex_);
        std::size_t best = count_;
        for (std::size_t i = 0; i < count_; ++i) {
            const std::size_t size = pieces_[i].size;
            if (size < bytes || size / 2 > bytes) continue;
            if (best == count_ || size < pieces_[best].size) best = i;
        }
        return best == count_ ? Piece{} : remove(best);
    }

    void keep(const Piece& piece) noexcept {
        if (piece.size > most_kept) return release(piece);
#ifdef MADV_FREE
        if (piece.size >= huge) (void)::madvise(piece.memory, piece.size, MADV_FREE);
#endif
        const std::scoped_lock lock(mutex_);
        while (count_ == pieces_.size() || bytes_ + piece.size > most_kept)
            release(remove(0));
        pieces_[count_++] = piece;
        bytes_ += piece.size;
    }

  private:
    std::mutex mutex_;
    std::array<Piece, 32> pieces_{};
    std::size_t count_ = 0;
    std::size_t bytes_ = 0;

    Piece remove(std::size_t place) noexcept {
        const Piece piece = pieces_[place];
        std::move(pieces_.begin() + place + 1, pieces_.begin() + count_, pieces_.begin() + place);
        --count_;
        bytes_ -= piece.size;
        return piece;
    }
};

// Never destroyed: arrays may be freed after everything else.
[[nodiscard]] Spare& spare() {
    static auto* const spare = new Spare; // NOLINT(*-owning-memory): never destroyed
    return *spare;
}

} // namespace

std::pair<void*, nb::capsule> LargeMemory::owned(std::size_t bytes) {
    std::unique_ptr<LargeMemory> made(new LargeMemory(bytes));
    const nb::capsule owner(made.get(), [](void* memory) noexcept {
        delete static_cast<LargeMemory*>(memory); // NOLINT(*-owning-memory): of a capsule
    });
    return {made.release()->piece_.memory, owner};
}

LargeMemory::LargeMemory(std::size_t bytes) : piece_(spare().take(bytes)) {
    if (piece_.memory == nullptr) piece_ = allocated(bytes);
}

LargeMemory::~LargeMemory() {
    spare().keep(piece_);
}

} // namespace rtamt::python
