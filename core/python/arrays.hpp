// Columns that come from numpy and results that go to it, neither copied.
#pragma once

#include "../program/snapshot.hpp"
#include "large_memory.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace rtamt::python {

namespace nb = nanobind;

using Column = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
using BoundsColumn = nb::ndarray<const double, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;
using Result = nb::ndarray<nb::numpy, double, nb::ndim<1>>;

// Memory of results, one piece an output, handed over to numpy.
class Results {
  public:
    void add(std::size_t size) {
        sizes_.push_back(size);
        memory_.push_back(make(size));
        pointers_.push_back(memory_.back().values);
    }

    [[nodiscard]] std::span<double* const> pointers() const noexcept { return pointers_; }

    [[nodiscard]] std::vector<Result> hand_over() {
        std::vector<Result> results;
        results.reserve(memory_.size());
        for (std::size_t i = 0; i < memory_.size(); ++i) {
            const auto [values, owner] = memory_[i];
            results.emplace_back(values, std::initializer_list<std::size_t>{sizes_[i]}, owner);
        }
        return results;
    }

  private:
    struct Memory {
        double* values;
        nb::capsule owner;
    };
    std::vector<std::size_t> sizes_;
    std::vector<Memory> memory_;
    std::vector<double*> pointers_;

    [[nodiscard]] static Memory make(std::size_t size) {
        const std::size_t bytes = size * sizeof(double);
        if (bytes >= LargeMemory::least) {
            auto [memory, owner] = LargeMemory::owned(bytes);
            return {static_cast<double*>(memory), std::move(owner)};
        }
        auto small = std::make_unique_for_overwrite<double[]>(size);
        const nb::capsule owner(
            small.get(), [](void* memory) noexcept { delete[] static_cast<double*>(memory); });
        return {small.release(), owner};
    }
};

// The columns' memory; they must be as many as the inputs and equally long.
[[nodiscard]] inline std::vector<const double*> pointers_of(const std::vector<Column>& columns,
                                                            std::size_t inputs, std::size_t count) {
    if (columns.size() != inputs) {
        throw std::invalid_argument("Got " + std::to_string(columns.size()) +
                                    " columns for a program with " + std::to_string(inputs) +
                                    " inputs.");
    }
    std::vector<const double*> pointers;
    pointers.reserve(columns.size());
    for (const Column& column : columns) {
        if (column.shape(0) != count) {
            throw std::invalid_argument("A column has " + std::to_string(column.shape(0)) +
                                        " samples where " + std::to_string(count) +
                                        " are expected.");
        }
        pointers.push_back(column.data());
    }
    return pointers;
}

[[nodiscard]] inline nb::bytes bytes_of(const Snapshot& snapshot) {
    return nb::bytes(snapshot.bytes().data(), snapshot.bytes().size());
}

// For reading, as long as the bytes are there.
[[nodiscard]] inline Snapshot snapshot_of(const nb::bytes& bytes) {
    return Snapshot({static_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
}

// Calls `work`, and lets other Python threads run meanwhile where the samples are many.
template <class Work>
auto without_gil(std::size_t samples, Work&& work) {
    constexpr std::size_t many = 4096;
    std::optional<nb::gil_scoped_release> release;
    if (samples >= many) release.emplace();
    return std::forward<Work>(work)();
}

} // namespace rtamt::python
