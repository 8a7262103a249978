#include "fleet.hpp"

#include "../discrete/undefined.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <new>
#include <stdexcept>

namespace rtamt::fleet {

namespace {

constexpr double no_time = std::numeric_limits<double>::quiet_NaN();

// Records begin with a cache line.
constexpr std::size_t alignment = 64;

[[nodiscard]] std::size_t arena_size(std::size_t record, std::size_t capacity) {
    if (capacity >= Keys::none / 2 ||
        capacity > (std::numeric_limits<std::size_t>::max() / 2 - alignment) / record) {
        throw std::bad_alloc();
    }
    return record * capacity + alignment;
}

[[nodiscard]] std::byte* aligned(void* memory) noexcept {
    const auto address = reinterpret_cast<std::uintptr_t>(memory);
    return static_cast<std::byte*>(memory) + ((alignment - address % alignment) % alignment);
}

} // namespace

// A block, and where its samples are in the batch.
struct Fleet::Running {
    std::array<std::byte*, block_size> records{};
    std::array<std::int64_t, block_size> slots{};
    std::size_t first = 0;                  // index of the first sample
    const std::uint32_t* indices = nullptr; // of all samples; null: from the first on
    Block block;

    [[nodiscard]] std::size_t index(std::size_t lane) const noexcept {
        return indices == nullptr ? first + lane : indices[lane];
    }
};

Fleet::Fleet(Program program, std::vector<std::string> names, const Settings& settings)
    : Fleet(std::move(program), std::move(names), settings, false) {}

Fleet::Fleet(Program program, std::vector<std::string> names, const Settings& settings,
             bool warming)
    : program_(std::move(program)), names_(std::move(names)), settings_(settings),
      slack_(settings.tolerance * settings.period), layout_(program_, names_, warming),
      memory_(arena_size(layout_.record_size(), settings.capacity)),
      arena_(aligned(memory_.take(memory_.bytes()))) {
    const std::size_t size = program_.instructions.size();
    registers_.resize(size * block_size);
    const std::vector<bool> guarded = program_.guarded();
    for (std::uint32_t i = 0; i < size; ++i) {
        const Instruction& instruction = program_.instructions[i];
        double* own = registers_.data() + std::size_t{i} * block_size;
        own_.push_back(own);
        at_.push_back(own);
        if (instruction.opcode == Opcode::constant) std::fill_n(own, block_size, instruction.x);
        if (instruction.opcode == Opcode::input) inputs_.push_back(i);
        const Kernel* kernel = layout_.kernel(i);
        if (kernel == nullptr) continue;
        running_.push_back(i);
        if (program_.can_fail(instruction)) failing_.push_back(i);
        if (!guarded[i]) continue;
        guarded_.push_back(i);
        guarded_state_ = guarded_state_ || kernel->sizes().head != 0;
    }
}

// ---- a batch ------------------------------------------------------------------------------------

// Calls visit(running) for each block until it returns false.
template <class Visit>
bool Fleet::each_block(const Batch& batch, Visit&& visit) {
    Running running;
    std::size_t begin = 0;
    const std::size_t whole[] = {batch.size()};
    for (const std::size_t end : rounds_.empty() ? std::span<const std::size_t>(whole) : rounds_) {
        for (; begin < end; begin += running.block.count) {
            running.first = begin;
            running.indices = order_.empty() ? nullptr : order_.data() + begin;
            const std::size_t count = std::min(block_size, end - begin);
            std::int64_t least = std::numeric_limits<std::int64_t>::max();
            for (std::size_t i = 0; i < count; ++i) {
                std::byte* here = record(places_[running.index(i)]);
                running.records[i] = here;
                running.slots[i] = Layout::header(here).samples;
                least = std::min(least, running.slots[i]);
            }
            running.block = {count, running.records.data(), running.slots.data(), least};
            request(begin + count, std::min(begin + count + block_size, batch.size()));
            if (!visit(running)) return false;
        }
    }
    return true;
}

// Has the records of samples brought from memory.
void Fleet::request(std::size_t begin, std::size_t end) noexcept {
    for (std::size_t i = begin; i < end; ++i) {
        const std::byte* here = record(places_[order_.empty() ? i : order_[i]]);
        for (std::size_t offset = 0; offset < layout_.hot_size(); offset += 64)
            prefetch(here + offset);
    }
}

std::optional<Rejected> Fleet::run(const Batch& batch, std::span<const Output> outputs) {
    std::optional<Rejected> wrong;
    if (!failing_.empty() && !guarded_state_) {
        // No record is needed to find out whether all values are defined.
        const bool defined = each_block(batch, [&](Running& running) {
            load(batch, running);
            compute(running, guarded_);
            wrong = undefined(batch, running);
            return !wrong;
        });
        if (!defined) {
            describe(*wrong, batch);
            return wrong;
        }
    }
    (void)each_block(batch, [&](Running& running) {
        if (settings_.restart) begin_again(batch, running);
        load(batch, running);
        compute(running, running_);
        if (guarded_state_) wrong = undefined(batch, running);
        if (wrong) return false;
        deliver(batch, running, outputs);
        return true;
    });
    return wrong;
}

// Begins a new trace of the keys that have a gap.
void Fleet::begin_again(const Batch& batch, Running& running) {
    for (std::size_t i = 0; i < running.block.count; ++i) {
        std::byte* here = running.records[i];
        const Header& header = Layout::header(here);
        if (header.samples == 0 || fits(batch.times[running.index(i)] - header.last)) continue;
        std::memset(here, 0, layout_.record_size());
        layout_.start(here);
        running.slots[i] = 0;
        running.block.least = 0;
    }
}

void Fleet::load(const Batch& batch, const Running& running) {
    for (const std::uint32_t input : inputs_) {
        const double* column =
            batch.columns[static_cast<std::size_t>(program_.instructions[input].n)];
        if (running.indices == nullptr) {
            at_[input] = column + running.first;
            continue;
        }
        at_[input] = own_[input];
        for (std::size_t i = 0; i < running.block.count; ++i)
            own_[input][i] = column[running.indices[i]];
    }
}

void Fleet::compute(const Running& running, std::span<const std::uint32_t> instructions) {
    const Block& block = running.block;
    for (const std::uint32_t i : instructions) {
        const Instruction& instruction = program_.instructions[i];
        const double* a = at_[instruction.a];
        const double* b = instruction.b == no_operand ? nullptr : at_[instruction.b];
        layout_.kernel(i)->run(block, a, b, own_[i]);
        if (layout_.warming() && program_.can_fail(instruction)) settle(running, i);
    }
}

// Of values that are not exact yet, an undefined one may only follow from that.
void Fleet::settle(const Running& running, std::uint32_t instruction) {
    for (std::size_t i = 0; i < running.block.count; ++i) {
        double& value = own_[instruction][i];
        if (!std::isnan(value)) continue;
        if (running.slots[i] < exact_from(running.records[i], instruction)) value = 0.0;
    }
}

// The first sample of a block where an operation has no value.
std::optional<Rejected> Fleet::undefined(const Batch& batch, const Running& running) {
    const Block& block = running.block;
    std::size_t first = block.count;
    std::uint32_t culprit = 0;
    for (const std::uint32_t instruction : failing_) {
        const double* values = own_[instruction];
        const std::int64_t lag = layout_.kernel(instruction)->lag();
        for (std::size_t place = discrete::first_undefined<Real>(values, {0, first}); place < first;
             place = discrete::first_undefined<Real>(values, {place + 1, first})) {
            if (running.slots[place] < lag) continue;
            first = place;
            culprit = instruction;
        }
    }
    if (first == block.count) return std::nullopt;
    const std::size_t index = running.index(first);
    std::byte* here = running.records[first];
    const Header& header = Layout::header(here);
    Rejected wrong{index, Rejected::Reason::undefined, header.samples, {}, culprit};
    const std::int64_t lag = program_.instructions[culprit].lag;
    wrong.samples -= lag;
    wrong.time = batch.times[index];
    if (lag > 0)
        wrong.time = time_at(layout_.clock(here), header, wrong.samples, layout_.ring(here));
    return wrong;
}

void Fleet::deliver(const Batch& batch, const Running& running, std::span<const Output> outputs) {
    const std::size_t count = running.block.count;
    for (std::size_t i = 0; i < count; ++i) {
        std::byte* here = running.records[i];
        Header& header = Layout::header(here);
        const double time = batch.times[running.index(i)];
        if (layout_.clocked()) add_time(Layout::clock(here), header, time, layout_.ring(here));
        header.last = time;
        ++header.samples;
    }
    for (std::size_t k = 0; k < outputs.size(); ++k) {
        const std::uint32_t instruction = program_.outputs[k];
        const std::int64_t lag = program_.instructions[instruction].lag;
        const double* values = at_[instruction];
        const Output& out = outputs[k];
        if (lag == 0 && running.indices == nullptr && !layout_.warming()) {
            std::copy_n(values, count, out.values + running.first);
            std::copy_n(batch.times + running.first, count, out.when + running.first);
            std::memset(out.known + running.first, 1, count);
            if (out.warming != nullptr) std::memset(out.warming + running.first, 0, count);
            continue;
        }
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t index = running.index(i);
            std::byte* here = running.records[i];
            const std::int64_t slot = running.slots[i];
            const bool warm =
                layout_.warming() && slot < layout_.exact(here)[1 + layout_.parts().size() + k];
            const bool known = slot >= lag && !warm;
            out.values[index] = known ? values[i] : 0.0;
            out.known[index] = static_cast<std::uint8_t>(known);
            if (out.warming != nullptr) out.warming[index] = static_cast<std::uint8_t>(warm);
            out.when[index] = !known     ? no_time
                              : lag == 0 ? batch.times[index]
                                         : time_at(Layout::clock(here), Layout::header(here),
                                                   slot - lag, layout_.ring(here));
        }
    }
}

// ---- times --------------------------------------------------------------------------------------

// The next time of a key, as discrete/timestamps.hpp.
void Fleet::add_time(ClockState& clock, const Header& header, double time,
                     double* ring) const noexcept {
    if (header.samples == 0) clock.origin = time;
    if (clock.regular == header.samples &&
        time == clock.origin + static_cast<double>(header.samples) * settings_.period) {
        ++clock.regular;
        return;
    }
    ring[clock.next] = time;
    if (++clock.next == layout_.times()) clock.next = 0;
}

double Fleet::time_at(const ClockState& clock, const Header& header, std::int64_t sample,
                      const double* ring) const noexcept {
    if (sample < clock.regular) {
        return clock.origin + static_cast<double>(sample) * settings_.period;
    }
    const auto back = static_cast<std::size_t>(header.samples - sample); // 1: the last
    return ring[clock.next >= back ? clock.next - back : clock.next + layout_.times() - back];
}

// From which slot on the value of an instruction is exact in a record of a changed requirement.
std::int64_t Fleet::exact_from(std::byte* record, std::uint32_t instruction) const {
    const auto parts = layout_.parts();
    std::vector<std::uint32_t> open{instruction};
    std::int64_t exact = 0;
    while (!open.empty()) {
        const std::uint32_t next = open.back();
        open.pop_back();
        const auto part = std::ranges::lower_bound(parts, next, {}, &Layout::Part::instruction);
        if (part != parts.end() && part->instruction == next) {
            exact = std::max(exact, layout_.exact(record)[1 + (part - parts.begin())]);
        } else {
            program_.each_operand(program_.instructions[next],
                                  [&](std::uint32_t operand) { open.push_back(operand); });
        }
    }
    return exact;
}

} // namespace rtamt::fleet
