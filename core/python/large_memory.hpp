// Memory of large arrays: huge pages where the system has them, and what was freed last is used
// again.
//
// A page costs more when it is touched for the first time than the evaluation of its samples, and
// the C library returns large pieces to the system as soon as they are freed.
//
// Cost: a lock and a look at a few pieces. Memory: 32 pieces are kept for reuse, of 128 MiB
// together; on Linux, those of huge pages are taken back when the system is short of memory.
// Elsewhere the limit is 32 MiB.
#pragma once

#include <nanobind/nanobind.h>

#include <cstddef>
#include <utility>

namespace rtamt::python {

namespace nb = nanobind;

class LargeMemory {
  public:
    // Smaller pieces are left to the C library, which keeps them.
    static constexpr std::size_t least = std::size_t{64} << 10U;

    // At least so many bytes, of any content, which belong to a Python object. Throws
    // std::bad_alloc.
    [[nodiscard]] static std::pair<void*, nb::capsule> owned(std::size_t bytes);

    ~LargeMemory();
    LargeMemory(const LargeMemory&) = delete;
    LargeMemory& operator=(const LargeMemory&) = delete;
    LargeMemory(LargeMemory&&) = delete;
    LargeMemory& operator=(LargeMemory&&) = delete;

    // Of `size` bytes.
    struct Piece {
        void* memory = nullptr;
        std::size_t size = 0;
    };

  private:
    Piece piece_;

    explicit LargeMemory(std::size_t bytes);
};

} // namespace rtamt::python
