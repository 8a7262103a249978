// The cells of a ring that an update is about to overwrite, kept so that it can be taken back.
//
// Memory: as many cells as the ring, lazily mapped like it; only programs that compute with the
// result of a temporal operator have one. Cost: an update copies as many cells as it overwrites;
// the whole ring when it wraps round, which is O(1) a sample on average.
#pragma once

#include "copy.hpp"

#include <cstddef>

namespace rtamt::discrete {

template <class Cell>
class Journal {
  public:
    explicit Journal(Cell* store) noexcept : store_(store) {}

    void save(const Cell* ring, std::size_t begin, std::size_t count) noexcept {
        begin_ = begin;
        count_ = count;
        copy_values(ring + begin, count, store_);
    }

    void restore(Cell* ring) const noexcept { copy_values(store_, count_, ring + begin_); }

  private:
    Cell* store_;
    std::size_t begin_ = 0;
    std::size_t count_ = 0;
};

} // namespace rtamt::discrete
