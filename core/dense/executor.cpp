#include "executor.hpp"

#include "call.hpp"
#include "constant.hpp"
#include "kernels.hpp"

#include <algorithm>
#include <stdexcept>

namespace rtamt::dense {

namespace {

// Samples of an input in one step of the frontier: registers of this size stay in the cache.
constexpr std::size_t block_size = 256;

// Samples come after this tick, so that the time between two of them is one too.
constexpr std::int64_t before_all = -(never / 2) - 1;

} // namespace

// ---- building -----------------------------------------------------------------------------------

Executor::Executor(Program program) : program_(std::move(program)), feeds_(program_.inputs) {
    const std::vector<bool> guards = guarded();
    const std::vector<std::int64_t> reach = reaches();
    kernels_.resize(program_.instructions.size());
    add_constants(guards);
    for (std::uint32_t i = 0; i < kernels_.size(); ++i) {
        const Instruction& instruction = program_.instructions[i];
        const std::int64_t lag = program_.operand_lag(instruction);
        kernels_[i] = instruction.opcode == Opcode::call ? make_call(instruction, lag)
                                                         : make_kernel(instruction);
        if (!kernels_[i]) continue;
        kernels_[i]->connect(operand(instruction.a, lag), operand(instruction.b, lag));
        (guards[i] ? guarded_ : free_).push_back({kernels_[i].get(), i, reach[i]});
    }
    for (const std::uint32_t output : program_.outputs)
        outputs_.push_back({operand(output, 0), program_.instructions[output].lag, false, 0.0});
}

std::unique_ptr<Kernel> Executor::make_call(const Instruction& instruction,
                                            std::int64_t lag) const {
    const CallSite& site = program_.calls[static_cast<std::size_t>(instruction.n)];
    auto kernel = std::make_unique<Call>(*site.kernel, site.setup, lag, instruction.lag);
    std::vector<const Events*> operands;
    program_.each_operand(instruction,
                          [&](std::uint32_t index) { operands.push_back(operand(index, lag)); });
    kernel->connect_operands(std::move(operands));
    return kernel;
}

// Which instructions can make NaN, or lead to one that can.
std::vector<bool> Executor::guarded() const {
    std::vector<bool> guarded(program_.instructions.size(), false);
    for (std::size_t i = guarded.size(); i-- > 0;) {
        const Instruction& instruction = program_.instructions[i];
        if (program_.can_fail(instruction)) guarded[i] = true;
        if (!guarded[i]) continue;
        program_.each_operand(instruction, [&](std::uint32_t operand) { guarded[operand] = true; });
    }
    return guarded;
}

// How long after the end of the trace, in arrival time, the values of each instruction still reach
// an output within the trace, or belong to the trace themselves. Later values need not exist.
std::vector<std::int64_t> Executor::reaches() const {
    std::vector<std::int64_t> reaches;
    reaches.reserve(program_.instructions.size());
    for (const Instruction& instruction : program_.instructions)
        reaches.push_back(instruction.lag);
    for (std::size_t i = reaches.size(); i-- > 0;) {
        const Instruction& instruction = program_.instructions[i];
        const std::int64_t past = instruction.opcode == Opcode::shift ? instruction.n : 0;
        program_.each_operand(instruction, [&](std::uint32_t source) {
            reaches[source] = std::max(reaches[source], reaches[i] - past);
        });
    }
    return reaches;
}

// A kernel for each constant and each lag of operands that it is combined with.
void Executor::add_constants(const std::vector<bool>& guarded) {
    const auto add = [&](std::uint32_t index, std::int64_t lag, bool guard) {
        const Instruction& source = program_.instructions[index];
        if (source.opcode != Opcode::constant) return;
        auto& kernel = constants_[{index, lag}];
        if (!kernel) kernel = std::make_unique<Constant>(lag, source.x);
        const auto same = [&](const Unit& unit) { return unit.kernel == kernel.get(); };
        if (guard && std::ranges::none_of(guarded_, same)) {
            std::erase_if(free_, same);
            guarded_.push_back({kernel.get(), index, 0});
        } else if (!guard && std::ranges::none_of(guarded_, same) &&
                   std::ranges::none_of(free_, same)) {
            free_.push_back({kernel.get(), index, 0});
        }
    };
    for (std::size_t i = 0; i < program_.instructions.size(); ++i) {
        const Instruction& instruction = program_.instructions[i];
        const std::int64_t lag = program_.operand_lag(instruction);
        program_.each_operand(instruction,
                              [&](std::uint32_t source) { add(source, lag, guarded[i]); });
    }
    for (const std::uint32_t output : program_.outputs)
        add(output, 0, false);
}

// The events of an instruction; those of a constant begin with the operands of this lag.
const Events* Executor::operand(std::uint32_t index, std::int64_t lag) const {
    if (index == no_operand) return nullptr;
    const Instruction& instruction = program_.instructions[index];
    if (instruction.opcode == Opcode::input) {
        return &feeds_[static_cast<std::size_t>(instruction.n)].view();
    }
    if (instruction.opcode == Opcode::constant) return &constants_.at({index, lag})->out();
    return &kernels_[index]->out();
}

std::size_t Executor::state_bytes() const noexcept {
    std::size_t bytes = 0;
    for (const auto& units : {std::span(guarded_), std::span(free_)}) {
        for (const Unit& unit : units)
            bytes += unit.kernel->bytes();
    }
    for (const Feed& feed : feeds_)
        bytes += feed.bytes();
    return bytes;
}

// ---- one step of the frontier -------------------------------------------------------------------

std::int64_t Executor::earliest_last() const noexcept {
    std::int64_t earliest = never;
    for (const Feed& feed : feeds_)
        earliest = std::min(earliest, *feed.last());
    return earliest;
}

std::int64_t Executor::latest_last() const noexcept {
    std::int64_t latest = -never;
    for (const Feed& feed : feeds_)
        latest = std::max(latest, *feed.last());
    return latest;
}

// Whether the trace has begun; begins it when every input has its first sample.
bool Executor::open() noexcept {
    if (started_) return true;
    if (feeds_.empty()) return false;
    std::int64_t origin = -never;
    for (const Feed& feed : feeds_) {
        if (!feed.first()) return false;
        origin = std::max(origin, *feed.first());
    }
    for (const auto& units : {std::span(guarded_), std::span(free_)}) {
        for (const Unit& unit : units)
            unit.kernel->begin(origin);
    }
    origin_ = origin;
    started_ = fresh_ = true;
    return true;
}

// Loads the inputs for the next step towards the target; answers how far it goes.
std::int64_t Executor::step(std::int64_t target) noexcept {
    if (fresh_) {
        for (Feed& feed : feeds_)
            feed.begin(origin_);
        fresh_ = false;
        return origin_;
    }
    std::int64_t frontier = std::min(target, later(frontier_, stride_));
    for (const Feed& feed : feeds_)
        frontier = std::min(frontier, feed.reach(block_size));
    for (Feed& feed : feeds_)
        feed.load(frontier, block_size);
    return frontier;
}

// Of all values that are NaN the one that arrives first, then of the first instruction: whatever
// else is NaN in this step can only follow from it.
bool Executor::run_guarded(std::int64_t frontier) {
    std::int64_t first = never;
    const Unit* culprit = nullptr;
    for (const Unit& unit : guarded_) {
        const std::int64_t arrival = unit.kernel->run(frontier);
        if (arrival < first && arrival <= later(end_, unit.reach)) [[unlikely]] {
            first = arrival;
            culprit = &unit;
        }
    }
    if (first == never) [[likely]] {
        return true;
    }
    const std::uint32_t instruction = culprit->instruction;
    failure_ = {instruction, first - program_.instructions[instruction].lag,
                Fault(culprit->kernel->fault())};
    return false;
}

void Executor::run_free(std::int64_t frontier) {
    for (const Unit& unit : free_)
        (void)unit.kernel->run(frontier);
}

void Executor::deliver(Lists outputs) {
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
        Output& output = outputs_[i];
        const Events events = *output.events;
        for (std::size_t place = 0; place < events.count; ++place) {
            const std::int64_t time = events.times[place] - output.lag;
            const double value = events.values[place];
            if (time > end_) break;
            if (output.told && value == output.last) continue;
            outputs[i].append(time, value);
            output.told = true;
            output.last = value;
        }
    }
}

// ---- updates ------------------------------------------------------------------------------------

// Runs everything up to the target; answers whether no value is NaN.
bool Executor::advance(std::int64_t target, Lists outputs) {
    while (fresh_ || frontier_ < target) {
        const std::int64_t frontier = step(target);
        if (!run_guarded(frontier)) return false;
        run_free(frontier);
        deliver(outputs);
        frontier_ = frontier;
    }
    return true;
}

// The same with the guarded group alone.
bool Executor::look(std::int64_t target) {
    while (fresh_ || frontier_ < target) {
        const std::int64_t frontier = step(target);
        if (!run_guarded(frontier)) return false;
        frontier_ = frontier;
    }
    return true;
}

// Looks for NaN up to the target and then, in longer steps, the tail; takes everything back.
bool Executor::survey(std::int64_t target, std::int64_t tail) {
    const std::int64_t frontier = frontier_;
    const bool fresh = fresh_;
    for (const Unit& unit : guarded_)
        unit.kernel->checkpoint();
    bool sound = look(target);
    if (sound && tail > frontier_) {
        stride_ = stride_to(tail);
        sound = look(tail);
        stride_ = never;
    }
    for (const Unit& unit : guarded_)
        unit.kernel->rollback();
    for (Feed& feed : feeds_)
        feed.rewind();
    frontier_ = frontier;
    fresh_ = fresh;
    return sound;
}

// Whether an update is one step, so that it fails before anything but the guarded group has moved.
bool Executor::one_block() const noexcept {
    return !fresh_ && std::ranges::all_of(
                          feeds_, [](const Feed& feed) { return feed.reach(block_size) == never; });
}

// With no more samples to come, steps of the frontier such that each brings about a block of
// events.
std::int64_t Executor::stride_to(std::int64_t target) const noexcept {
    std::size_t pending = 0;
    for (const auto& units : {std::span(guarded_), std::span(free_)}) {
        for (const Unit& unit : units)
            pending = std::max(pending, unit.kernel->pending());
    }
    const auto steps = static_cast<std::int64_t>(pending / block_size + 1);
    return std::max<std::int64_t>((target - frontier_) / steps, 1);
}

// Moves the frontier as far as every input is known.
bool Executor::update(Lists outputs) {
    const bool starting = !started_;
    if (!open()) return true;
    const std::int64_t target = earliest_last();
    if (target < origin_ || (!fresh_ && target <= frontier_)) return true;
    if (guarded_.empty()) return advance(target, outputs);
    if (!one_block()) {
        if (survey(target, target)) return advance(target, outputs);
        started_ = !starting;
        return false;
    }
    for (const Unit& unit : guarded_)
        unit.kernel->checkpoint();
    if (advance(target, outputs)) return true;
    for (const Unit& unit : guarded_)
        unit.kernel->rollback();
    return false;
}

std::optional<Failure> Executor::push(std::span<const Events> inputs, Lists outputs) {
    if (finished_) {
        throw std::logic_error("The trace has ended: reset the monitor before the next sample.");
    }
    for (std::size_t i = 0; i < feeds_.size(); ++i)
        feeds_[i].attach(inputs[i]);
    const bool sound = update(outputs);
    for (Feed& feed : feeds_)
        sound ? feed.settle() : feed.restore();
    if (!sound) return failure_;
    return std::nullopt;
}

// Moves the frontier to the end, where every input holds its last value.
bool Executor::complete(std::int64_t extra, bool checked, Lists outputs) {
    const std::int64_t last = latest_last();
    end_ = later(last, extra);
    const std::int64_t tail = std::min(later(end_, program_.latest()), never - 1);
    if (!checked && !guarded_.empty() && !survey(last, tail)) return false;
    if (!advance(last, outputs)) return false;
    stride_ = stride_to(tail);
    const bool sound = advance(tail, outputs);
    stride_ = never;
    return sound;
}

std::optional<Failure> Executor::finish(Lists outputs) {
    if (finished_) return std::nullopt;
    for (Feed& feed : feeds_)
        feed.attach({});
    const bool sound = !open() || complete(0, false, outputs);
    for (Feed& feed : feeds_)
        sound ? feed.settle() : feed.restore();
    if (!sound) {
        end_ = never;
        return failure_;
    }
    finished_ = true;
    return std::nullopt;
}

void Executor::reset() noexcept {
    for (Feed& feed : feeds_)
        feed.reset();
    for (Output& output : outputs_)
        output.told = false;
    stride_ = end_ = never;
    started_ = fresh_ = finished_ = false;
}

void Executor::transfer(Snapshot& snapshot) {
    snapshot.item(origin_);
    snapshot.item(frontier_);
    snapshot.item(end_);
    snapshot.item(started_);
    snapshot.item(fresh_);
    snapshot.item(finished_);
    for (Feed& feed : feeds_)
        feed.transfer(snapshot);
    for (Output& output : outputs_) {
        snapshot.item(output.told);
        snapshot.item(output.last);
    }
    snapshot.require(sound());
    if (!started_ || finished_) return; // kernels begin before they run again
    for (const auto& units : {std::span(guarded_), std::span(free_)}) {
        for (const Unit& unit : units) {
            if (snapshot.loading()) unit.kernel->begin(origin_);
            if (!fresh_) unit.kernel->transfer(snapshot, frontier_);
        }
    }
}

// Whether the times are such as updates leave behind.
bool Executor::sound() const noexcept {
    const auto waits_from_the_start = [](const Feed& feed) { return feed.next() == feed.first(); };
    const auto in_range = [&](const Feed& feed) {
        return !feed.first() || (*feed.first() > before_all && *feed.last() <= last_possible());
    };
    if (!std::ranges::all_of(feeds_, in_range)) return false;
    if (!started_) {
        return end_ == never && std::ranges::all_of(feeds_, waits_from_the_start);
    }
    std::int64_t origin = -never;
    for (const Feed& feed : feeds_) {
        if (!feed.first()) return false;
        origin = std::max(origin, *feed.first());
    }
    if (feeds_.empty() || origin_ != origin) return false;
    if (finished_) return !fresh_ && end_ == latest_last();
    if (end_ != never) return false;
    if (fresh_) return std::ranges::all_of(feeds_, waits_from_the_start);
    return frontier_ >= origin_ && frontier_ == earliest_last() &&
           std::ranges::all_of(feeds_, [&](const Feed& feed) {
               return feed.next() ? *feed.next() > frontier_ : *feed.last() == frontier_;
           });
}

std::optional<Failure> Executor::evaluate(Program program, std::span<const Events> inputs,
                                          std::int64_t extra, Lists outputs) {
    Executor executor(std::move(program));
    for (std::size_t i = 0; i < inputs.size(); ++i)
        executor.feeds_[i].attach(inputs[i]);
    if (executor.open() && !executor.complete(extra, true, outputs)) return executor.failure_;
    return std::nullopt;
}

std::optional<std::int64_t> Executor::start() const noexcept {
    if (!started_) return std::nullopt;
    return origin_;
}

std::optional<std::int64_t> Executor::known_until(std::size_t output) const noexcept {
    if (!started_ || fresh_) return std::nullopt;
    if (finished_) return end_;
    const std::int64_t lag = outputs_[output].lag;
    if (frontier_ < later(origin_, lag)) return std::nullopt;
    return frontier_ - lag;
}

} // namespace rtamt::dense
