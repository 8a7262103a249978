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

std::optional<Rejected> Fleet::update(const Batch& batch, std::span<const Output> outputs) {
    const std::size_t count = batch.size();
    if (count == 0) return std::nullopt;
    if (count > Keys::none / 2) {
        throw std::invalid_argument("A batch has at most 2147483647 samples: split it.");
    }
    if (keys_.size() == 0) keys_.set_kind(batch.keys.kind);
    if (keys_.kind() != batch.keys.kind) {
        throw std::invalid_argument(
            "The keys of a fleet are all integers, all texts, or all bytes.");
    }
    const std::size_t old_size = size();
    try {
        return take(batch, outputs, old_size);
    } catch (...) { // before a record has changed
        forget_from(old_size);
        throw;
    }
}

std::optional<Rejected> Fleet::take(const Batch& batch, std::span<const Output> outputs,
                                    std::size_t old_size) {
    const std::size_t count = batch.size();
    auto wrong = wrong_value(batch);
    const std::size_t checked = wrong ? wrong->index + 1 : count;
    places_.resize(count);
    const auto bad_key = batch.keys.kind == KeyKind::integer
                             ? admit(batch.keys.integers, batch, checked)
                             : admit(batch.keys.texts, batch, checked);
    if (bad_key) wrong = bad_key; // its index is not greater, and a time comes before a value
    if (wrong) {
        describe(*wrong, batch);
        forget_from(old_size);
        return wrong;
    }
    if (guarded_state_) save(count, old_size);
    wrong = run(batch, outputs);
    if (wrong) {
        if (guarded_state_) put_back(count, old_size);
        forget_from(old_size);
    }
    return wrong;
}

// The first value that is NaN.
std::optional<Rejected> Fleet::wrong_value(const Batch& batch) const {
    std::optional<Rejected> wrong;
    std::size_t count = batch.size();
    for (std::size_t input = 0; input < batch.columns.size(); ++input) {
        const std::size_t place = discrete::first_undefined<Real>(batch.columns[input], {0, count});
        if (place == discrete::Kernel::defined) continue;
        wrong = Rejected{place, Rejected::Reason::value, 0, {}, static_cast<std::uint32_t>(input)};
        count = place;
    }
    return wrong;
}

// Finds the places of the first keys of a batch, of new ones too, and checks their times.
template <class Key>
std::optional<Rejected> Fleet::admit(std::span<const Key> keys, const Batch& batch,
                                     std::size_t count) {
    if (marks_ > Keys::none - 2 - count) {
        keys_.clear_marks();
        marks_ = 0;
    }
    const std::uint32_t base = marks_;
    marks_ += static_cast<std::uint32_t>(count);
    std::array<std::uint64_t, 2 * block_size> codes{};
    std::array<std::uint32_t, block_size> before{}; // index + 1 of the sample before; 0: none
    std::uint32_t most = 0;
    turns_.clear();
    const auto request = [&](std::size_t first) { // the next block, while this one is looked at
        for (std::size_t i = first; i < std::min(first + block_size, count); ++i) {
            codes[i % codes.size()] = keys_.code(keys[i]);
            keys_.request(codes[i % codes.size()]);
        }
    };
    request(0);
    for (std::size_t first = 0; first < count; first += block_size) {
        const std::size_t size = std::min(block_size, count - first);
        request(first + block_size);
        for (std::size_t i = 0; i < size; ++i) {
            const std::size_t index = first + i;
            Keys::Entry* entry = keys_.find(keys[index], codes[index % codes.size()]);
            if (entry == nullptr) [[unlikely]] {
                if (this->size() == settings_.capacity) {
                    return Rejected{index, Rejected::Reason::full};
                }
                layout_.start(record(this->size()));
                entry = keys_.add(keys[index], codes[index % codes.size()]);
            }
            places_[index] = entry->place;
            prefetch(record(entry->place));
            before[i] = entry->mark > base ? entry->mark - base : 0;
            entry->mark = base + static_cast<std::uint32_t>(index) + 1;
            if (before[i] != 0 && turns_.empty()) turns_.assign(batch.size(), 0);
            if (!turns_.empty() && before[i] != 0) {
                most = std::max(most, turns_[index] = turns_[before[i] - 1] + 1);
            }
        }
        for (std::size_t i = 0; i < size; ++i) {
            const std::size_t index = first + i;
            const double time = batch.times[index];
            const Header& header = Layout::header(record(places_[index]));
            const bool begins = before[i] == 0 && header.samples == 0;
            const double last = before[i] == 0 ? header.last : batch.times[before[i] - 1];
            if (std::isfinite(time) && (begins || fits(time - last))) [[likely]] {
                continue;
            }
            const bool later = std::isfinite(time) && time > last;
            if (later && settings_.restart) continue;
            return Rejected{index, later ? Rejected::Reason::gap : Rejected::Reason::time};
        }
    }
    take_turns(count, most);
    return std::nullopt;
}

// What its key knew before the sample that is wrong; the samples before it are admitted.
void Fleet::describe(Rejected& wrong, const Batch& batch) {
    if (wrong.reason == Rejected::Reason::full) return;
    const std::uint32_t place = places_[wrong.index];
    const Header& header = Layout::header(record(place));
    wrong.samples = header.samples;
    if (header.samples != 0) wrong.last = header.last;
    for (std::size_t i = 0; i < wrong.index; ++i) {
        if (places_[i] != place) continue;
        const bool again = wrong.last && settings_.restart && !fits(batch.times[i] - *wrong.last);
        wrong.samples = again ? 1 : wrong.samples + 1;
        wrong.last = batch.times[i];
    }
}

// Sorts the samples by how often their key came before, if one comes twice.
void Fleet::take_turns(std::size_t count, std::uint32_t most) {
    rounds_.clear();
    order_.clear();
    if (most == 0) return;
    rounds_.assign(std::size_t{most} + 1, 0);
    for (std::size_t i = 0; i < count; ++i)
        ++rounds_[turns_[i]];
    std::vector<std::size_t> next(rounds_.size());
    for (std::size_t round = 1; round < rounds_.size(); ++round) {
        next[round] = rounds_[round - 1];
        rounds_[round] += rounds_[round - 1];
    }
    order_.resize(count);
    for (std::size_t i = 0; i < count; ++i)
        order_[next[turns_[i]]++] = static_cast<std::uint32_t>(i);
}

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

// ---- keys ---------------------------------------------------------------------------------------

std::optional<std::size_t> Fleet::drop(const KeySpan& keys) {
    for (std::size_t i = 0; i < keys.size(); ++i) {
        if (!place_of(keys, i)) return i;
    }
    for (std::size_t i = 0; i < keys.size(); ++i) {
        if (const auto place = place_of(keys, i)) erase(*place); // the same key may come again
    }
    return std::nullopt;
}

std::size_t Fleet::expire(double before) {
    const std::size_t old_size = size();
    for (std::size_t place = old_size; place-- > 0;) {
        if (Layout::header(record(place)).last < before) erase(static_cast<std::uint32_t>(place));
    }
    return old_size - size();
}

std::optional<std::uint32_t> Fleet::place_of(const KeySpan& keys, std::size_t index) noexcept {
    if (keys.kind != keys_.kind()) return std::nullopt;
    const auto place = [&](auto key) -> std::optional<std::uint32_t> {
        const Keys::Entry* entry = keys_.find(key, keys_.code(key));
        return entry == nullptr ? std::nullopt : std::optional(entry->place);
    };
    return keys.kind == KeyKind::integer ? place(keys.integers[index]) : place(keys.texts[index]);
}

// Forgets the key at a place, which the last one takes. Unused records are zero.
void Fleet::erase(std::uint32_t place) noexcept {
    keys_.erase(place);
    std::byte* last = record(size());
    if (place != size()) std::memcpy(record(place), last, layout_.record_size());
    std::memset(last, 0, layout_.record_size());
}

void Fleet::forget_from(std::size_t old_size) noexcept {
    while (size() > old_size)
        erase(static_cast<std::uint32_t>(size() - 1));
}

// ---- undoing ------------------------------------------------------------------------------------

// Copies the records of a batch, each before its key's first sample.
void Fleet::save(std::size_t count, std::size_t old_size) {
    saved_.clear();
    for (std::size_t i = 0; i < count; ++i) {
        if (places_[i] >= old_size || (!turns_.empty() && turns_[i] != 0)) continue;
        const std::byte* here = record(places_[i]);
        saved_.insert(saved_.end(), here, here + layout_.record_size());
    }
}

void Fleet::put_back(std::size_t count, std::size_t old_size) noexcept {
    const std::byte* next = saved_.data();
    for (std::size_t i = 0; i < count; ++i) {
        if (places_[i] >= old_size || (!turns_.empty() && turns_[i] != 0)) continue;
        std::memcpy(record(places_[i]), next, layout_.record_size());
        next += layout_.record_size();
    }
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
