// Runs the stages of a plan over a whole trace, or over as many traces as a value has lanes.
//
// Cost: that of the executors and scans. Memory: the executors; of traces of n samples, n values
// for each output of a stage and each scan, until release().
#pragma once

#include "../program/stages.hpp"
#include "../values/domain.hpp"
#include "executor.hpp"
#include "scan.hpp"

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace rtamt::discrete {

template <ValueDomain D>
class PlanRunner {
  public:
    using Value = typename D::Value;
    using Column = typename BasicExecutor<D>::Column;

    // The stages have to outlive it.
    explicit PlanRunner(std::span<const Stage> stages) : stages_(stages) {
        for (const Stage& stage : stages)
            executors_.push_back(std::make_unique<BasicExecutor<D>>(stage.program));
    }

    // The value at each of `count` samples; null where one is undefined. Then there is no other
    // run. The values are in `result`, or in a column of their own until the next run.
    [[nodiscard]] const Value* run(std::span<const Column> variables, std::size_t count,
                                   Value* result) {
        columns_.assign(variables.begin(), variables.end());
        std::size_t used = 0;
        for (std::size_t i = 0; i < stages_.size(); ++i) {
            const Stage& stage = stages_[i];
            inputs_.clear();
            for (const std::size_t column : stage.columns)
                inputs_.push_back(columns_[column]);
            if (i + 1 == stages_.size()) return last(stage, *executors_[i], count, result);
            outputs_.clear();
            for (std::size_t k = 0; k < stage.program.outputs.size(); ++k)
                outputs_.push_back(own(used++, count));
            if (executors_[i]->evaluate(inputs_, count, outputs_)) return nullptr;
            for (const Scan& scan : stage.scans) {
                Value* scanned = own(used++, count);
                run(scan, count, scanned);
                columns_.push_back(scanned);
            }
        }
        return nullptr;
    }

    // Frees what depends on the length of traces.
    void release() noexcept { own_.clear(); }

  private:
    std::span<const Stage> stages_;
    std::vector<std::unique_ptr<BasicExecutor<D>>> executors_;
    std::vector<std::vector<Value>> own_; // operands and results of scans
    std::vector<Column> columns_;
    std::vector<Column> inputs_;
    std::vector<Value*> outputs_;

    [[nodiscard]] Value* own(std::size_t place, std::size_t count) {
        if (place >= own_.size()) own_.resize(place + 1);
        if (own_[place].size() < count) own_[place].resize(count);
        return own_[place].data();
    }

    // The last program is often nothing but a scan that was asked for.
    [[nodiscard]] const Value* last(const Stage& stage, BasicExecutor<D>& executor,
                                    std::size_t count, Value* result) {
        const Instruction& output = stage.program.instructions[stage.program.outputs.front()];
        if (output.opcode == Opcode::input) {
            return static_cast<const Value*>(inputs_[static_cast<std::size_t>(output.n)]);
        }
        outputs_.assign(1, result);
        return executor.evaluate(inputs_, count, outputs_) ? nullptr : result;
    }

    void run(const Scan& scan, std::size_t count, Value* result) noexcept {
        const std::span<const Value> a(outputs_[scan.a], count);
        const std::span<Value> out(result, count);
        switch (scan.kind) {
        case ScanKind::run_max:
            discrete::scan<MaxOf<D>>(a, out);
            break;
        case ScanKind::run_min:
            discrete::scan<MinOf<D>>(a, out);
            break;
        case ScanKind::until:
            discrete::scan_until<D>(a, {outputs_[scan.b], count}, out);
            break;
        }
    }
};

} // namespace rtamt::discrete
