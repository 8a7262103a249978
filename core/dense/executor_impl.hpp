// The definitions of executor.hpp, for the files that instantiate it for a domain (real.cpp and its
// neighbours).
#pragma once

#include "executor.hpp"

#include <algorithm>
#include <stdexcept>

namespace rtamt::dense {

namespace detail {

// Samples of an input in one step of the frontier: registers of this size stay in the cache.
inline constexpr std::size_t block_size = 256;

// Samples come after this tick, so that the time between two of them is one too.
inline constexpr std::int64_t before_all = -(never / 2) - 1;

} // namespace detail

template <ValueDomain D>
BasicExecutor<D>::BasicExecutor(Program program)
    : wiring_(std::move(program)), outputs_(wiring_.program().outputs.size()),
      last_possible_(never - 1 - wiring_.program().latest()) {
    for (std::size_t i = 0; i < outputs_.size(); ++i)
        outputs_[i].lag = this->program().instructions[this->program().outputs[i]].lag;
}

template <ValueDomain D>
std::size_t BasicExecutor<D>::state_bytes() const noexcept {
    return wiring_.bytes();
}

// ---- one step of the frontier -------------------------------------------------------------------

template <ValueDomain D>
std::int64_t BasicExecutor<D>::earliest_last() const noexcept {
    std::int64_t earliest = never;
    for (const auto& queue : queues())
        earliest = std::min(earliest, *queue.last());
    return earliest;
}

template <ValueDomain D>
std::int64_t BasicExecutor<D>::latest_last() const noexcept {
    std::int64_t latest = -never;
    for (const auto& queue : queues())
        latest = std::max(latest, *queue.last());
    return latest;
}

// Whether the trace has begun; begins it when every input has its first sample.
template <ValueDomain D>
bool BasicExecutor<D>::open() noexcept {
    if (started_) return true;
    if (queues().empty()) return false;
    std::int64_t origin = -never;
    for (const auto& queue : queues()) {
        if (!queue.first()) return false;
        origin = std::max(origin, *queue.first());
    }
    wiring_.units().each([&](const Unit& unit) { unit.kernel->begin(origin); });
    origin_ = origin;
    started_ = fresh_ = true;
    constants_ = Constants::waiting;
    return true;
}

// Loads the inputs for the next step towards the target; returns how far it goes.
template <ValueDomain D>
std::int64_t BasicExecutor<D>::step(std::int64_t target) noexcept {
    if (fresh_) {
        for (auto& queue : queues())
            queue.begin(origin_);
        fresh_ = false;
        return origin_;
    }
    std::int64_t frontier = std::min(target, later(frontier_, stride_));
    for (const auto& queue : queues())
        frontier = std::min(frontier, queue.reach(detail::block_size));
    for (auto& queue : queues())
        queue.load(frontier, detail::block_size);
    return frontier;
}

// Every kernel has run up to the frontier.
template <ValueDomain D>
void BasicExecutor<D>::moved_to(std::int64_t frontier) noexcept {
    frontier_ = frontier;
    if (constants_ == Constants::begun) constants_ = Constants::done;
    if (constants_ == Constants::waiting && frontier >= later(origin_, wiring_.latest_constant())) {
        constants_ = Constants::begun;
    }
}

// Returns whether no value is undefined.
template <ValueDomain D>
bool BasicExecutor<D>::run_guarded(std::int64_t frontier) {
    const bool skips = constants_ == Constants::done;
    const auto failed = wiring_.units().run_guarded(never, [&](const Unit& unit) {
        if (skips && unit.constant) return never;
        const std::int64_t arrival = unit.kernel->run(frontier);
        return arrival <= later(end_, unit.reach) ? arrival : never;
    });
    if (!failed) [[likely]] {
        return true;
    }
    const auto [culprit, first] = *failed;
    const std::uint32_t instruction = culprit->instruction;
    failure_ = {instruction, first - program().instructions[instruction].lag,
                Fault(culprit->kernel->fault())};
    return false;
}

template <ValueDomain D>
void BasicExecutor<D>::run_free(std::int64_t frontier) {
    const bool skips = constants_ == Constants::done;
    wiring_.units().run_free([&](const Unit& unit) {
        if (!skips || !unit.constant) (void)unit.kernel->run(frontier);
    });
}

template <ValueDomain D>
void BasicExecutor<D>::deliver(Outputs outputs) {
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
        Output& output = outputs_[i];
        const BasicEvents<Formula> events = wiring_.output(i);
        for (std::size_t place = 0; place < events.count; ++place) {
            const std::int64_t time = events.times[place] - output.lag;
            const Formula value = events.values[place];
            if (time > end_) break;
            if (output.emitted && value == output.last) continue;
            outputs[i].append(time, value);
            output.emitted = true;
            output.last = value;
        }
    }
}

// ---- updates ------------------------------------------------------------------------------------

// Runs everything up to the target; returns whether no value is NaN.
template <ValueDomain D>
bool BasicExecutor<D>::advance(std::int64_t target, Outputs outputs) {
    while (fresh_ || frontier_ < target) {
        const std::int64_t frontier = step(target);
        if (!run_guarded(frontier)) return false;
        run_free(frontier);
        deliver(outputs);
        moved_to(frontier);
    }
    return true;
}

// The same with the guarded group alone.
template <ValueDomain D>
bool BasicExecutor<D>::run_guarded_to(std::int64_t target) {
    while (fresh_ || frontier_ < target) {
        const std::int64_t frontier = step(target);
        if (!run_guarded(frontier)) return false;
        frontier_ = frontier;
    }
    return true;
}

// Looks for NaN up to the target and then, in longer steps, the tail; takes everything back.
template <ValueDomain D>
bool BasicExecutor<D>::dry_run(std::int64_t target, std::int64_t tail) {
    const std::int64_t frontier = frontier_;
    const bool fresh = fresh_;
    const bool valid = wiring_.units().dry_run([&] {
        if (!run_guarded_to(target)) return false;
        if (tail <= frontier_) return true;
        stride_ = stride_to(tail);
        const bool settled = run_guarded_to(tail);
        stride_ = never;
        return settled;
    });
    for (auto& queue : queues())
        queue.rewind();
    frontier_ = frontier;
    fresh_ = fresh;
    constants_ = Constants::waiting;
    return valid;
}

// Whether an update is one step, so that it fails before anything but the guarded group has moved.
template <ValueDomain D>
bool BasicExecutor<D>::one_block() const noexcept {
    return !fresh_ && std::ranges::all_of(queues(), [](const auto& queue) {
        return queue.reach(detail::block_size) == never;
    });
}

// Without further samples, steps of the frontier such that each brings about a block of
// events.
template <ValueDomain D>
std::int64_t BasicExecutor<D>::stride_to(std::int64_t target) const noexcept {
    std::size_t pending = 0;
    wiring_.units().each(
        [&](const Unit& unit) { pending = std::max(pending, unit.kernel->pending()); });
    const auto steps = static_cast<std::int64_t>(pending / detail::block_size + 1);
    return std::max<std::int64_t>((target - frontier_) / steps, 1);
}

// Moves the frontier as far as every input is known.
template <ValueDomain D>
bool BasicExecutor<D>::update(Outputs outputs) {
    const bool starting = !started_;
    const std::int64_t origin = origin_;
    if (!open()) return true;
    const std::int64_t target = earliest_last();
    if (target < origin_ || (!fresh_ && target <= frontier_)) return true;
    if (!wiring_.units().can_fail()) return advance(target, outputs);
    if (!one_block()) {
        if (dry_run(target, target)) return advance(target, outputs);
        if (starting) { // nothing has changed
            started_ = fresh_ = false;
            origin_ = origin;
        }
        return false;
    }
    wiring_.units().checkpoint();
    if (advance(target, outputs)) return true;
    wiring_.units().rollback();
    constants_ = Constants::waiting;
    return false;
}

template <ValueDomain D>
std::optional<Failure> BasicExecutor<D>::push(Inputs inputs, Outputs outputs) {
    if (finished_) {
        throw std::logic_error("The trace has ended: reset the monitor before the next sample.");
    }
    for (std::size_t i = 0; i < queues().size(); ++i)
        queues()[i].attach(inputs[i]);
    const bool valid = update(outputs);
    for (auto& queue : queues())
        valid ? queue.settle() : queue.restore();
    if (!valid) return failure_;
    return std::nullopt;
}

// Moves the frontier to the end, where every input holds its last value.
template <ValueDomain D>
bool BasicExecutor<D>::complete(std::int64_t extra, bool checked, Outputs outputs) {
    const std::int64_t last = latest_last();
    end_ = later(last, extra);
    const std::int64_t tail = std::min(later(end_, program().latest()), never - 1);
    if (!checked && wiring_.units().can_fail() && !dry_run(last, tail)) return false;
    if (!advance(last, outputs)) return false;
    stride_ = stride_to(tail);
    const bool valid = advance(tail, outputs);
    stride_ = never;
    return valid;
}

template <ValueDomain D>
std::optional<Failure> BasicExecutor<D>::finish(Outputs outputs) {
    if (finished_) return std::nullopt;
    for (auto& queue : queues())
        queue.attach({});
    const bool valid = !open() || complete(0, false, outputs);
    for (auto& queue : queues())
        valid ? queue.settle() : queue.restore();
    if (!valid) {
        end_ = never;
        return failure_;
    }
    finished_ = true;
    return std::nullopt;
}

template <ValueDomain D>
void BasicExecutor<D>::reset() noexcept {
    for (auto& queue : queues())
        queue.reset();
    for (Output& output : outputs_)
        output.emitted = false;
    stride_ = end_ = never;
    started_ = fresh_ = finished_ = false;
}

template <ValueDomain D>
void BasicExecutor<D>::transfer(Snapshot& snapshot) {
    snapshot.item(origin_);
    snapshot.item(frontier_);
    snapshot.item(end_);
    snapshot.item(started_);
    snapshot.item(fresh_);
    snapshot.item(finished_);
    for (auto& queue : queues())
        queue.transfer(snapshot);
    for (Output& output : outputs_) {
        snapshot.item(output.emitted);
        snapshot.item(output.last);
    }
    snapshot.require(valid());
    constants_ = Constants::waiting;
    if (!started_ || finished_) return; // kernels begin before they run again
    wiring_.units().each([&](const Unit& unit) {
        if (snapshot.loading()) unit.kernel->begin(origin_);
        if (!fresh_) unit.kernel->transfer(snapshot, frontier_);
    });
}

// Whether the times are such as updates leave behind.
template <ValueDomain D>
bool BasicExecutor<D>::valid() const noexcept {
    const auto waits_from_the_start = [](const auto& queue) {
        return queue.next() == queue.first();
    };
    const auto in_range = [&](const auto& queue) {
        return !queue.first() ||
               (*queue.first() > detail::before_all && *queue.last() <= last_possible());
    };
    if (!std::ranges::all_of(queues(), in_range)) return false;
    if (!started_) {
        return end_ == never && std::ranges::all_of(queues(), waits_from_the_start);
    }
    std::int64_t origin = -never;
    for (const auto& queue : queues()) {
        if (!queue.first()) return false;
        origin = std::max(origin, *queue.first());
    }
    if (queues().empty() || origin_ != origin) return false;
    if (finished_) return !fresh_ && end_ == latest_last();
    if (end_ != never) return false;
    if (fresh_) return std::ranges::all_of(queues(), waits_from_the_start);
    return frontier_ >= origin_ && frontier_ == earliest_last() &&
           std::ranges::all_of(queues(), [&](const auto& queue) {
               return queue.next() ? *queue.next() > frontier_ : *queue.last() == frontier_;
           });
}

template <ValueDomain D>
std::optional<Failure> BasicExecutor<D>::evaluate(Inputs inputs, std::int64_t extra,
                                                  Outputs outputs) {
    reset();
    for (std::size_t i = 0; i < inputs.size(); ++i)
        queues()[i].attach(inputs[i]);
    if (open() && !complete(extra, true, outputs)) return failure_;
    return std::nullopt;
}

template <ValueDomain D>
std::optional<Failure> BasicExecutor<D>::evaluate(Program program, Inputs inputs,
                                                  std::int64_t extra, Outputs outputs) {
    return BasicExecutor(std::move(program)).evaluate(inputs, extra, outputs);
}

template <ValueDomain D>
std::optional<std::int64_t> BasicExecutor<D>::start() const noexcept {
    if (!started_) return std::nullopt;
    return origin_;
}

template <ValueDomain D>
std::optional<std::int64_t> BasicExecutor<D>::known_until(std::size_t output) const noexcept {
    if (!started_ || fresh_) return std::nullopt;
    if (finished_) return end_;
    const std::int64_t lag = outputs_[output].lag;
    if (frontier_ < later(origin_, lag)) return std::nullopt;
    return frontier_ - lag;
}

} // namespace rtamt::dense
