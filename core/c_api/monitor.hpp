// The monitor behind the C API and FMUs. All input is checked; wrong input raises
// std::invalid_argument with one sentence, and a failed call leaves the monitor unchanged.
#pragma once

#include "../program/metadata.hpp"
#include "../program/program.hpp"
#include "rtamt.h"
#include "runner.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rtamt::c_api {

class Monitor {
  public:
    explicit Monitor(std::span<const std::uint8_t> program);

    // A copy, state and all.
    Monitor(Monitor& other);
    ~Monitor() = default;
    Monitor& operator=(const Monitor&) = delete;
    Monitor(Monitor&&) = delete;
    Monitor& operator=(Monitor&&) = delete;

    [[nodiscard]] const Metadata& metadata() const noexcept { return metadata_; }
    [[nodiscard]] const Program& program() const noexcept { return runner_->program(); }
    [[nodiscard]] const Runner& runner() const noexcept { return *runner_; }
    [[nodiscard]] std::int64_t samples() const; // 0 in dense time
    [[nodiscard]] double parameter(std::size_t index) const noexcept;

    void set_parameter(std::size_t index, double value);
    // Throws std::invalid_argument if set_parameter would.
    void check_parameter(std::size_t index, double value) const;
    // Its index; throws std::invalid_argument if there is none of this name.
    [[nodiscard]] std::size_t parameter_called(std::string_view name) const;
    void step(std::span<const double> row, std::span<rtamt_value> known);

    // The same sample `count` times, all of them or none; what the last one made known. Memory does
    // not grow with `count`.
    void hold(std::span<const double> row, std::size_t count, std::span<rtamt_value> known);
    void push(std::span<const rtamt_sample> samples);
    void finish();
    void reset();

    [[nodiscard]] std::vector<std::uint8_t> save();
    void restore(std::span<const std::uint8_t> state);

    // The sentence for a value that does not exist.
    [[nodiscard]] std::string undefined(const Undefined& failure) const;

  private:
    std::uint32_t checksum_ = 0; // of the program as loaded, without parameters set since
    Metadata metadata_;
    std::unique_ptr<Runner> runner_;
    bool apart_ = false;  // requirements read different inputs
    bool broken_ = false; // memory ran out in the middle of something

    [[nodiscard]] std::string time_of(std::int64_t step) const;
    [[nodiscard]] SampledRunner& discrete() const;
    [[nodiscard]] DenseRunner& dense() const;
    void check_row(std::span<const double> row, std::size_t outputs) const;
    void require_truth(std::size_t input, double value, std::int64_t step) const;
    void require_whole() const;
    void require_ready() const;
    void add(DenseRunner& runner, const rtamt_sample& sample) const;
    void require_one_start(const DenseRunner& runner, const rtamt_sample& sample) const;
    template <class Work>
    void unbroken(Work&& work);
};

} // namespace rtamt::c_api
