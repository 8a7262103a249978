// Runs a program over events in dense time: online in chunks of any size, offline in one.
//
// A trace begins at the latest first time of all inputs. Its frontier is the earliest last time: so
// far every input is known. An update moves the frontier, in steps of at most a block of samples an
// input, and every kernel brings its events up to it (kernel.hpp). finish() lets every input hold
// its last value and moves the frontier on until the outputs are known at the latest last time.
//
// Kernels run in the two groups of rollback_plan.hpp. An update of more than one block runs the
// guarded group over the whole chunk once to look for undefined values, takes it back, and then
// runs everything.
//
// An executor is a template over the value domain of the program's formulas, as in discrete time
// (discrete/executor.hpp): predicates take numbers and give formulas. Inputs are numbers.
//
// Cost: a virtual call an instruction and block, and O(1) an event, amortised. Memory: the events
// inside the windows, and the samples that wait for other inputs. When memory runs out in the
// middle of an update (std::bad_alloc), only reset() helps.
#pragma once

#include "../program/fault.hpp"
#include "../program/program.hpp"
#include "../values/domain.hpp"
#include "../values/real.hpp"
#include "events.hpp"
#include "input_queue.hpp"
#include "wiring.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace rtamt::dense {

// An operation made NaN: which instruction, and the time of the value. Or a call failed: what it
// said.
struct Failure {
    std::uint32_t instruction = 0;
    std::int64_t time = 0;
    Fault fault;
};

template <ValueDomain D>
class BasicExecutor {
  public:
    using Formula = typename D::Value;
    using Number = typename D::Number::Value;
    using Inputs = std::span<const BasicEvents<Number>>;
    using Outputs = std::span<BasicEventList<Formula>>;

    explicit BasicExecutor(Program program);
    ~BasicExecutor() = default;
    BasicExecutor(const BasicExecutor&) = delete;
    BasicExecutor& operator=(const BasicExecutor&) = delete;
    BasicExecutor(BasicExecutor&&) = delete; // kernels point to inputs
    BasicExecutor& operator=(BasicExecutor&&) = delete;

    // New samples, one list an input, each later than the last time of its input and not later than
    // last_possible(). What becomes known of each output is appended to its list: equal neighbours
    // merged, also over updates. Nothing is appended by an update that fails.
    [[nodiscard]] std::optional<Failure> push(Inputs inputs, Outputs outputs);

    // No more samples: the rest of each output, up to the last time of all inputs. Then only
    // reset() helps.
    [[nodiscard]] std::optional<Failure> finish(Outputs outputs);

    void reset() noexcept;

    // Writes or reads what the samples so far have left behind, for an executor of the same
    // program. Discard an executor that could not read.
    void transfer(Snapshot& snapshot);

    // A whole trace at once, the last values held for `extra` more ticks, independent of earlier
    // input. Then only another whole trace may follow; after a failure, nothing.
    [[nodiscard]] std::optional<Failure> evaluate(Inputs inputs, std::int64_t extra,
                                                  Outputs outputs);

    // A whole trace with a separate executor.
    [[nodiscard]] static std::optional<Failure> evaluate(Program program, Inputs inputs,
                                                         std::int64_t extra, Outputs outputs);

    [[nodiscard]] const Program& program() const noexcept { return wiring_.program(); }
    [[nodiscard]] bool finished() const noexcept { return finished_; }

    // When the trace begins, once every input has a sample.
    [[nodiscard]] std::optional<std::int64_t> start() const noexcept;

    // Until when an output is known, that instant included.
    [[nodiscard]] std::optional<std::int64_t> known_until(std::size_t output) const noexcept;

    // The value of an output there; any number while it is known nowhere.
    [[nodiscard]] Formula value(std::size_t output) const noexcept { return outputs_[output].last; }

    [[nodiscard]] std::optional<std::int64_t> first_time(std::size_t input) const noexcept {
        return queues()[input].first();
    }

    [[nodiscard]] std::optional<std::int64_t> last_time(std::size_t input) const noexcept {
        return queues()[input].last();
    }

    // The latest time a sample may have, so that the end of the trace is within the range of ticks.
    [[nodiscard]] std::int64_t last_possible() const noexcept { return last_possible_; }

    [[nodiscard]] std::size_t state_bytes() const noexcept;

  private:
    struct Output {
        std::int64_t lag = 0;
        bool emitted = false; // whether it has a value yet
        Formula last{};       // and which
    };

    // Constants run until they have put out their only event, and once more to put out nothing.
    enum class Constants : std::uint8_t { waiting, begun, done };

    Wiring<D> wiring_;
    std::vector<Output> outputs_;
    std::int64_t last_possible_;
    std::int64_t origin_ = 0;     // when the trace begins
    std::int64_t frontier_ = 0;   // how far it is known
    std::int64_t stride_ = never; // longest step of the frontier
    std::int64_t end_ = never;    // up to when outputs are known
    bool started_ = false;        // origin_ is known
    bool fresh_ = false;          // and nothing has run yet
    bool finished_ = false;
    Constants constants_ = Constants::waiting;
    Failure failure_{};

    [[nodiscard]] std::vector<InputQueue<Number>>& queues() noexcept { return wiring_.queues(); }
    [[nodiscard]] const std::vector<InputQueue<Number>>& queues() const noexcept {
        return wiring_.queues();
    }

    [[nodiscard]] bool open() noexcept;
    [[nodiscard]] bool valid() const noexcept;
    [[nodiscard]] std::int64_t earliest_last() const noexcept;
    [[nodiscard]] std::int64_t latest_last() const noexcept;
    [[nodiscard]] std::int64_t step(std::int64_t target) noexcept;
    void moved_to(std::int64_t frontier) noexcept;
    [[nodiscard]] bool run_guarded(std::int64_t frontier);
    void run_free(std::int64_t frontier);
    void deliver(Outputs outputs);
    [[nodiscard]] bool advance(std::int64_t target, Outputs outputs);
    [[nodiscard]] bool run_guarded_to(std::int64_t target);
    [[nodiscard]] bool dry_run(std::int64_t target, std::int64_t tail);
    [[nodiscard]] bool one_block() const noexcept;
    [[nodiscard]] std::int64_t stride_to(std::int64_t target) const noexcept;
    [[nodiscard]] bool update(Outputs outputs);
    [[nodiscard]] bool complete(std::int64_t extra, bool checked, Outputs outputs);
};

using Executor = BasicExecutor<Real>;

} // namespace rtamt::dense
