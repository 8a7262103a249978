// The first samples of a trace in dense time, while an earlier one may still set its start.
//
// They are kept until the start is known. One that has no value then would stop the monitor for
// good, so that it is taken by an engine of its own at once, with all before it, as if the trace
// started at the latest first sample of an input.
//
// Cost: that of an engine which learns the tick of each sample; where an operation without a value
// depends on the start, all of them again when that moves earlier. Memory: its runs, until the
// trace starts.
#pragma once

#include "bounds_engine.hpp"
#include "samples.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace rtamt::early {

class DenseRehearsal {
  public:
    // Takes what was added to samples since their last commit, which nothing has to be taken back
    // of if it fails; else accept or reject follows. `like`: the engine of the trace. The tick of a
    // failure is the caller's.
    [[nodiscard]] std::optional<BoundsEngine::Failure> attempt(const Samples& samples,
                                                               const BoundsEngine& like);
    void accept() noexcept;
    void reject();
    // Forgets all samples: the next attempt takes them again.
    void clear() noexcept;

    [[nodiscard]] std::size_t bytes() const noexcept;

  private:
    struct Taken {
        BoundsEngine engine;
        Tick origin; // the caller's tick that is 0 of the engine
        Tick start;  // from where on it knows the samples
    };
    enum class Change : std::uint8_t { nothing, learned, replaced };

    std::optional<Taken> taken_;
    // How to take back the last attempt.
    Change change_ = Change::nothing;
    std::optional<Taken> replaced_;
    Tick start_before_ = 0;
    std::vector<BoundsEngine::Observation> observations_;

    [[nodiscard]] std::optional<BoundsEngine::Failure> begin(const Samples& samples,
                                                             const BoundsEngine& like, Tick start);
};

} // namespace rtamt::early
