#include "monitor.hpp"

#include "../program/crc32.hpp"
#include "../program/reader.hpp"
#include "../program/snapshot.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <new>
#include <stdexcept>
#include <utility>

namespace rtamt::c_api {

namespace {

constexpr std::size_t checksum_size = 4;

// How many equal samples a runner takes at once, for which it needs columns of that length.
constexpr std::size_t longest_hold = 4096;

// Times lie between these, so that bounds can be added to them.
constexpr std::int64_t farthest = 4'611'686'018'427'387'904; // 2^62

[[noreturn]] void refuse(const std::string& sentence) {
    throw std::invalid_argument(sentence);
}

[[nodiscard]] std::string shown(double number) {
    char text[32];
    (void)std::snprintf(text, sizeof text, "%.15g", number);
    return text;
}

[[nodiscard]] std::string listed(const std::vector<std::string>& names) {
    std::string list;
    for (const std::string& name : names)
        list += (list.empty() ? "" : ", ") + name;
    return list.empty() ? "the formula reads no variable" : list;
}

[[nodiscard]] constexpr bool is_truth(double value) noexcept {
    return value == 0.0 || value == 1.0;
}

[[nodiscard]] bool has_member(const Enumeration& enumeration, double value) {
    return std::ranges::any_of(enumeration.members, [&](const Enumeration::Member& member) {
        return static_cast<double>(member.code) == value;
    });
}

// The codes of an enumeration with the names of the members, for a message.
[[nodiscard]] std::string codes_of(const Enumeration& enumeration) {
    constexpr std::size_t most = 12;
    const auto& members = enumeration.members;
    const std::size_t shown = std::min(members.size(), most);
    std::string list;
    for (std::size_t i = 0; i < shown; ++i) {
        const bool last = i + 1 == members.size();
        list += i == 0 ? "" : last ? " or " : ", ";
        list += std::to_string(members[i].code) + " (" + members[i].name + ")";
    }
    if (shown == members.size()) return list;
    return list + " or one of " + std::to_string(members.size() - shown) + " more";
}

[[nodiscard]] Domain domain_of(std::span<const std::uint8_t> program) noexcept {
    constexpr std::size_t place = 10;
    return program.size() > place && program[place] == 1 ? Domain::dense : Domain::discrete;
}

// Whether requirements read different inputs, so that in dense time each trace would have a start
// of its own. The first two outputs are of all requirements together. A requirement that reads no
// input has no trace.
[[nodiscard]] bool apart(const Program& program) {
    std::vector<std::vector<bool>> reads(program.instructions.size());
    for (std::size_t i = 0; i < reads.size(); ++i) {
        const Instruction& instruction = program.instructions[i];
        reads[i].resize(program.inputs);
        if (instruction.opcode == Opcode::input) {
            reads[i][static_cast<std::size_t>(instruction.n)] = true;
            continue;
        }
        program.each_operand(instruction, [&](std::uint32_t operand) {
            for (std::size_t input = 0; input < program.inputs; ++input)
                reads[i][input] = reads[i][input] || reads[operand][input];
        });
    }
    const std::vector<bool> nothing(program.inputs);
    const std::vector<bool>* first = nullptr;
    for (std::size_t output = 2; output < program.outputs.size(); ++output) {
        const std::vector<bool>& own = reads[program.outputs[output]];
        if (own == nothing) continue;
        if (first != nullptr && own != *first) return true;
        first = &own;
    }
    return false;
}

} // namespace

Monitor::Monitor(std::span<const std::uint8_t> program) {
    Program parsed = Program::parse(program, domain_of(program));
    checksum_ = Reader(program.last(checksum_size)).take<std::uint32_t>();
    metadata_ = Metadata::parse(parsed);
    apart_ = parsed.domain == Domain::dense && apart(parsed);
    runner_ = make_runner(std::move(parsed), metadata_);
}

Monitor::Monitor(Monitor& other)
    : checksum_(other.checksum_), metadata_(other.metadata_),
      runner_(make_runner(other.program(), metadata_)), apart_(other.apart_) {
    other.require_whole();
    Snapshot saved;
    other.runner_->transfer(saved);
    Snapshot read(saved.bytes());
    runner_->transfer(read);
}

std::int64_t Monitor::samples() const {
    return program().domain == Domain::discrete ? discrete().samples() : 0;
}

double Monitor::parameter(std::size_t index) const noexcept {
    return program().instructions[metadata_.parameters[index].instructions.front()].x;
}

std::size_t Monitor::parameter_called(std::string_view name) const {
    std::string known;
    for (std::size_t i = 0; i < metadata_.parameters.size(); ++i) {
        if (metadata_.parameters[i].name == name) return i;
        known += (i == 0 ? "" : ", ") + metadata_.parameters[i].name;
    }
    refuse("There is no parameter '" + std::string(name) + "': the program has " +
           (known.empty() ? "none" : known) + ".");
}

void Monitor::check_parameter(std::size_t index, double value) const {
    const std::vector<Parameter>& parameters = metadata_.parameters;
    if (index >= parameters.size()) {
        refuse("There is no parameter " + std::to_string(index) + ": the program has " +
               std::to_string(parameters.size()) + ".");
    }
    const Parameter& parameter = parameters[index];
    if (std::isnan(value)) refuse("The parameter '" + parameter.name + "' may not be NaN.");
    if (parameter.boolean && !is_truth(value)) {
        refuse("The parameter '" + parameter.name + "' is " + shown(value) +
               ", and declared as bool: give 1 or 0.");
    }
    const Enumeration& type = parameter.enumeration;
    if (!type.members.empty() && !has_member(type, value)) {
        refuse("The parameter '" + parameter.name + "' is " + shown(value) + ", and declared as " +
               type.name + ": give " + codes_of(type) + ".");
    }
    if (runner_->begun()) {
        refuse("The parameter '" + parameter.name +
               "' cannot change in the middle of a trace: set it before the first sample.");
    }
}

void Monitor::set_parameter(std::size_t index, double value) {
    check_parameter(index, value);
    Program patched = program();
    for (const std::uint32_t place : metadata_.parameters[index].instructions)
        patched.instructions[place].x = value;
    runner_ = make_runner(std::move(patched), metadata_);
    broken_ = false;
}

void Monitor::step(std::span<const double> row, std::span<rtamt_value> known) {
    SampledRunner& runner = discrete();
    require_ready();
    check_row(row, known.size());
    unbroken([&] { runner.step(row.data(), known); });
}

void Monitor::hold(std::span<const double> row, std::size_t count, std::span<rtamt_value> known) {
    SampledRunner& runner = discrete();
    require_ready();
    check_row(row, known.size());
    if (count <= longest_hold) return unbroken([&] { runner.hold(row, count, known); });
    Snapshot before;
    runner.transfer(before);
    try {
        for (std::size_t left = count; left != 0;) {
            const std::size_t part = std::min(left, longest_hold);
            runner.hold(row, part, known);
            left -= part;
        }
    } catch (...) {
        unbroken([&] {
            Snapshot read(before.bytes());
            runner.transfer(read);
        });
        throw;
    }
}

// Refuses a sample that has the wrong number of values, or one among them that is NaN, outside its
// declared range, or neither 1 nor 0 in place of a Boolean.
void Monitor::check_row(std::span<const double> row, std::size_t outputs) const {
    const std::int64_t sample = samples();
    if (row.size() != metadata_.inputs.size()) {
        refuse("Sample " + std::to_string(sample) + " has the wrong number of values: expected " +
               std::to_string(metadata_.inputs.size()) + " (" + listed(metadata_.inputs) +
               "), got " + std::to_string(row.size()) + ".");
    }
    if (outputs > program().outputs.size()) {
        refuse("The program has " + std::to_string(program().outputs.size()) + " outputs, not " +
               std::to_string(outputs) + ".");
    }
    for (std::size_t i = 0; i < row.size(); ++i) {
        if (std::isnan(row[i])) {
            refuse("'" + metadata_.inputs[i] + "' is NaN at " + time_of(sample) +
                   ": fill the gap or leave the sample out.");
        }
    }
    for (const std::uint32_t input : metadata_.booleans)
        require_truth(input, row[input], sample);
    const std::span<const Bounds> ranges = discrete().ranges();
    for (std::size_t i = 0; i < ranges.size(); ++i) {
        if (row[i] < ranges[i].lower || row[i] > ranges[i].upper) {
            refuse("'" + metadata_.inputs[i] + "' is " + shown(row[i]) + " at " + time_of(sample) +
                   ", outside its declared range [" + shown(ranges[i].lower) + ", " +
                   shown(ranges[i].upper) + "]: correct the value, or declare a wider range.");
        }
    }
}

// Refuses a value of a Boolean that is neither 1 nor 0; `step`: its sample or tick.
void Monitor::require_truth(std::size_t input, double value, std::int64_t step) const {
    if (is_truth(value)) return;
    refuse("'" + metadata_.inputs[input] + "' is " + shown(value) + " at " + time_of(step) +
           ", and declared as bool: give 1 or 0.");
}

void Monitor::push(std::span<const rtamt_sample> samples) {
    DenseRunner& runner = dense();
    require_ready();
    unbroken([&] {
        try {
            for (const rtamt_sample& sample : samples)
                add(runner, sample);
        } catch (...) {
            runner.discard();
            throw;
        }
        runner.push();
    });
}

// One sample to those that are pushed together.
void Monitor::add(DenseRunner& runner, const rtamt_sample& sample) const {
    if (sample.input >= metadata_.inputs.size()) {
        refuse("There is no input " + std::to_string(sample.input) + ": the program has " +
               std::to_string(metadata_.inputs.size()) + " (" + listed(metadata_.inputs) + ").");
    }
    const std::string& name = metadata_.inputs[sample.input];
    if (std::isnan(sample.value)) {
        refuse("'" + name + "' is NaN at " + time_of(sample.tick) +
               ": fill the gap or leave the sample out.");
    }
    if (std::ranges::find(metadata_.booleans, sample.input) != metadata_.booleans.end())
        require_truth(sample.input, sample.value, sample.tick);
    if (sample.tick <= -farthest || sample.tick >= farthest ||
        sample.tick > runner.last_possible()) {
        refuse("'" + name + "' has a sample at tick " + std::to_string(sample.tick) +
               ", too far from 0: subtract a start time, or choose a coarser resolution.");
    }
    const auto last = runner.last(sample.input);
    if (last && sample.tick <= *last) {
        refuse("The time of '" + name + "' does not increase: " + time_of(sample.tick) +
               " comes after " + time_of(*last) + ".");
    }
    if (apart_ && !last) require_one_start(runner, sample);
    runner.add(sample.input, sample.tick, sample.value);
}

// Refuses the first sample of an input at another time than that of the others: the requirements
// have one trace here, but the verdict of each is about the trace of its own inputs.
void Monitor::require_one_start(const DenseRunner& runner, const rtamt_sample& sample) const {
    for (std::size_t input = 0; input < metadata_.inputs.size(); ++input) {
        const auto first = runner.first(input);
        if (!first || *first == sample.tick) continue;
        refuse("'" + metadata_.inputs[input] + "' starts at " + time_of(*first) + " and '" +
               metadata_.inputs[sample.input] + "' at " + time_of(sample.tick) +
               ", but the requirements of this program read different inputs and share one trace: "
               "start all inputs together, or compile each requirement alone.");
    }
}

void Monitor::finish() {
    if (runner_->finished()) refuse("The trace has been finished before: reset the monitor.");
    require_ready();
    unbroken([&] { runner_->finish(); });
}

void Monitor::reset() {
    unbroken([&] { runner_->reset(); });
    broken_ = false;
}

// ---- state --------------------------------------------------------------------------------------

// Checksum of the program, values of the parameters, what the runner has, checksum of all that.
std::vector<std::uint8_t> Monitor::save() {
    require_whole();
    Snapshot snapshot;
    snapshot.item(checksum_);
    for (std::size_t i = 0; i < metadata_.parameters.size(); ++i) {
        double value = parameter(i);
        snapshot.item(value);
    }
    runner_->transfer(snapshot);
    std::vector<std::uint8_t> state = snapshot.bytes();
    const std::uint32_t sum = crc32(state);
    for (unsigned shift = 0; shift < 32; shift += 8)
        state.push_back(static_cast<std::uint8_t>(sum >> shift));
    return state;
}

void Monitor::restore(std::span<const std::uint8_t> state) {
    if (state.size() < checksum_size || Reader(state.last(checksum_size)).take<std::uint32_t>() !=
                                            crc32(state.first(state.size() - checksum_size))) {
        refuse("This is not a state of a monitor, or it was damaged on the way.");
    }
    Snapshot snapshot(state.first(state.size() - checksum_size));
    std::uint32_t checksum = 0;
    snapshot.item(checksum);
    if (checksum != checksum_) refuse("This is the state of a monitor of another program.");
    Program patched = program();
    for (const Parameter& parameter : metadata_.parameters) {
        double value = 0.0;
        snapshot.item(value);
        for (const std::uint32_t place : parameter.instructions)
            patched.instructions[place].x = value;
    }
    auto runner = make_runner(std::move(patched), metadata_);
    runner->transfer(snapshot);
    snapshot.end();
    runner_ = std::move(runner);
    broken_ = false;
}

// ---- errors -------------------------------------------------------------------------------------

std::string Monitor::undefined(const Undefined& failure) const {
    const auto found = metadata_.meanings.find(failure.instruction);
    const std::string what = found != metadata_.meanings.end()
                                 ? "'" + found->second + "'"
                                 : "Instruction " + std::to_string(failure.instruction);
    return what + " has no value at " + time_of(failure.step) +
           ": it is 0/0, inf - inf, 0 * inf, or a function outside its domain; change "
           "the formula or the data so that this cannot happen.";
}

std::string Monitor::time_of(std::int64_t step) const {
    const double seconds = static_cast<double>(step) * metadata_.seconds();
    if (program().domain == Domain::dense) return "time " + shown(seconds) + " s";
    return "sample " + std::to_string(step) + ", time " + shown(seconds) + " s";
}

SampledRunner& Monitor::discrete() const {
    if (program().domain != Domain::discrete) {
        refuse("The program is for dense time: use rtamt_push.");
    }
    return static_cast<SampledRunner&>(*runner_);
}

DenseRunner& Monitor::dense() const {
    if (program().domain != Domain::dense) {
        refuse("The program is for discrete time: use rtamt_step.");
    }
    return static_cast<DenseRunner&>(*runner_);
}

void Monitor::require_whole() const {
    if (broken_) refuse("Memory ran out before: reset the monitor.");
}

void Monitor::require_ready() const {
    require_whole();
    if (runner_->finished()) {
        refuse("The trace has ended: reset the monitor before the next sample.");
    }
}

// Does something that leaves the runner neither here nor there when memory runs out.
template <class Work>
void Monitor::unbroken(Work&& work) {
    try {
        std::forward<Work>(work)();
    } catch (const std::bad_alloc&) {
        broken_ = true;
        throw;
    }
}

} // namespace rtamt::c_api
