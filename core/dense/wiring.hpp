// A program made ready to run in dense time: inputs, kernels, and which reads which.
//
// A constant is a step function that begins where its reader's operands do, and so a kernel for
// each such lag. Where an instruction is read as a value of the other sort, and the values of both
// sorts differ, a kernel right after it makes the one of the other. Inputs are numbers.
//
// Cost: none once it is connected. Memory: the events inside the windows, and the samples that wait
// for other inputs.
#pragma once

#include "../program/program.hpp"
#include "../program/rollback_plan.hpp"
#include "../values/domain.hpp"
#include "events.hpp"
#include "input_queue.hpp"
#include "kernel.hpp"

#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

namespace rtamt::dense {

struct Unit {
    Kernel* kernel;
    std::uint32_t instruction;
    std::int64_t reach; // how long after the end of the trace an output depends on it
    bool constant;
};

template <ValueDomain D>
class Wiring {
  public:
    using Formula = typename D::Value;
    using Number = typename D::Number::Value;

    explicit Wiring(Program program);
    ~Wiring() = default;
    Wiring(const Wiring&) = delete;
    Wiring& operator=(const Wiring&) = delete;
    Wiring(Wiring&&) = delete; // kernels point to inputs
    Wiring& operator=(Wiring&&) = delete;

    [[nodiscard]] const Program& program() const noexcept { return program_; }
    [[nodiscard]] const RollbackPlan<Unit>& units() const noexcept { return units_; }
    [[nodiscard]] std::size_t bytes() const noexcept;

    // The latest lag of a constant: when, after the start of the trace, all of them have begun.
    [[nodiscard]] std::int64_t latest_constant() const noexcept { return latest_constant_; }

    // By input.
    [[nodiscard]] std::vector<InputQueue<Number>>& queues() noexcept { return queues_; }
    [[nodiscard]] const std::vector<InputQueue<Number>>& queues() const noexcept { return queues_; }

    // The events of the last run of an output.
    [[nodiscard]] const BasicEvents<Formula>& output(std::size_t output) const noexcept {
        return *outputs_[output];
    }

  private:
    // What stands for an instruction where a value of this sort is read: a constant with the lag of
    // its reader's operands, or a copy of the other sort.
    struct Stand {
        std::uint32_t instruction;
        Sort sort;
        std::int64_t lag;
        auto operator<=>(const Stand&) const = default;
    };
    struct StandIn {
        std::unique_ptr<Kernel> kernel;
        bool guarded = false;
    };

    Program program_;
    std::vector<Sort> sorts_;                      // by instruction
    std::vector<std::unique_ptr<Kernel>> kernels_; // by instruction; none for inputs and constants
    std::map<Stand, StandIn> stands_;
    std::int64_t latest_constant_ = 0;
    RollbackPlan<Unit> units_;
    std::vector<InputQueue<Number>> queues_;
    std::vector<const BasicEvents<Formula>*> outputs_;

    [[nodiscard]] std::vector<std::int64_t> reaches() const;
    void add_constants(const std::vector<bool>& guarded);
    [[nodiscard]] std::unique_ptr<Kernel> make_call(const Instruction& instruction,
                                                    std::int64_t lag) const;
    void cross(std::uint32_t index, Sort sort, bool guarded);
    [[nodiscard]] Stand stand(std::uint32_t index, Sort sort, std::int64_t lag) const noexcept;
    [[nodiscard]] const void* own(std::uint32_t index) const;
    [[nodiscard]] const void* operand(std::uint32_t index, Sort sort, std::int64_t lag) const;
};

} // namespace rtamt::dense
