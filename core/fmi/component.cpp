#include "component.hpp"

#include "../program/crc32.hpp"
#include "../program/reader.hpp"
#include "../values/ticks.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <utility>

namespace rtamt::fmi {

namespace {

constexpr std::size_t checksum_size = 4;

// How far, as a part of the period, a communication point may miss a sampling instant.
constexpr double tolerance = 1e-6;

// How many samples a step may take.
constexpr std::int64_t longest_step = 100'000'000;

// The variables of an Outcome, in this order.
enum class Output : std::uint32_t { robustness, verdict, known, since, lower, upper };

[[nodiscard]] constexpr Output output_of(std::uint32_t place, bool early) noexcept {
    constexpr std::array bounds{Output::lower, Output::upper, Output::verdict, Output::since};
    const std::uint32_t field = place % Component::fields;
    return early ? bounds[field] : static_cast<Output>(field);
}

// By how many seconds two computations of the same communication point may differ.
[[nodiscard]] double rounding_of(double time) noexcept {
    return 4.0 * std::numeric_limits<double>::epsilon() * std::abs(time);
}

[[noreturn]] void refuse(const std::string& sentence) {
    throw std::invalid_argument(sentence);
}

[[nodiscard]] std::string shown(double number) {
    std::array<char, 32> text{};
    (void)std::snprintf(text.data(), text.size(), "%.12g", number);
    return text.data();
}

[[nodiscard]] std::vector<std::uint8_t> read(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) refuse("The program '" + path + "' cannot be read.");
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

// The checksum at the end of a program names it.
[[nodiscard]] std::string token_of(std::span<const std::uint8_t> program) {
    std::array<char, 20> text{};
    const auto sum = Reader(program.last(checksum_size)).take<std::uint32_t>();
    (void)std::snprintf(text.data(), text.size(), "rtamt-%08x", sum);
    return text.data();
}

[[nodiscard]] int hexadecimal(char digit) noexcept {
    if (digit >= '0' && digit <= '9') return digit - '0';
    if (digit >= 'a' && digit <= 'f') return digit - 'a' + 10;
    if (digit >= 'A' && digit <= 'F') return digit - 'A' + 10;
    return -1;
}

} // namespace

std::string path_of(const std::string& uri) {
    std::string rest = uri;
    for (const std::string prefix : {"file://localhost/", "file:///", "file:/"}) {
        if (uri.starts_with(prefix)) {
            rest = uri.substr(prefix.size() - 1);
            break;
        }
    }
    std::string path;
    for (std::size_t i = 0; i < rest.size(); ++i) {
        const bool escaped = rest[i] == '%' && i + 2 < rest.size() &&
                             hexadecimal(rest[i + 1]) >= 0 && hexadecimal(rest[i + 2]) >= 0;
        path += escaped
                    ? static_cast<char>(16 * hexadecimal(rest[i + 1]) + hexadecimal(rest[i + 2]))
                    : rest[i];
        i += escaped ? 2 : 0;
    }
    const bool drive = path.size() > 2 && path[0] == '/' && path[2] == ':'; // of Windows
    return drive ? path.substr(1) : path;
}

Component::Component(const std::string& folder, const std::string& token)
    : program_(read(folder + "/program.rtamt")),
      monitor_(std::make_unique<c_api::Monitor>(program_)) {
    if (token != token_of(program_)) {
        refuse("The model description is for the program '" + token + "', but the unit carries '" +
               token_of(program_) + "'.");
    }
    const std::size_t count = monitor_->program().outputs.size();
    if (count == 0 || count % 2 != 0) {
        refuse("The program has " + std::to_string(count) +
               " outputs, but a unit needs a robustness and a verdict of each requirement.");
    }
    now_ = fresh();
}

Component::Now Component::fresh() const {
    Now fresh;
    fresh.outcomes.resize(is_early() ? 1 : monitor_->program().outputs.size() / 2);
    if (is_early()) {
        constexpr double infinity = std::numeric_limits<double>::infinity();
        fresh.outcomes.front().robustness = -infinity;
        fresh.outcomes.front().upper = infinity;
    }
    fresh.inputs.resize(monitor_->metadata().inputs.size());
    return fresh;
}

// ---- lifecycle ----------------------------------------------------------------------------------

void Component::require(Phase phase, const char* call, const char* when) const {
    if (now_.phase != phase) refuse(std::string(call) + " is only possible " + when + ".");
}

void Component::begin(double time) {
    require(Phase::created, "Setting the start time", "before the initialisation begins");
    if (!std::isfinite(time)) refuse("The start time is " + shown(time) + ": it must be finite.");
    now_.start = now_.reached = time;
}

void Component::initialise() {
    require(Phase::created, "The beginning of the initialisation", "once, or after a reset");
    now_.phase = Phase::initialising;
}

void Component::settle() {
    require(Phase::initialising, "The end of the initialisation", "after its beginning");
    now_.phase = Phase::stepping;
}

void Component::terminate() {
    require(Phase::stepping, "The end of the simulation", "once, after the initialisation");
    now_.phase = Phase::terminated;
}

void Component::reset() {
    monitor_ = std::make_unique<c_api::Monitor>(program_);
    now_ = fresh();
}

// ---- steps --------------------------------------------------------------------------------------

void Component::advance(double time, double length) {
    if (now_.phase != Phase::stepping) {
        refuse(
            "There is no step before the end of the initialisation, and none after the end of the "
            "simulation.");
    }
    if (!std::isfinite(time) || !(length >= 0.0) || !std::isfinite(time + length)) {
        refuse("A step from " + shown(time) + " s of " + shown(length) +
               " s is none: both must be finite, and the length not negative.");
    }
    if (length == 0.0) return; // an iteration at an event: nothing passes
    if (monitor_->program().domain == Domain::dense) {
        advance_dense(time);
    } else {
        advance_discrete(time, time + length);
    }
    now_.reached = time + length;
}

// The index of the sample at this time.
std::int64_t Component::instant(double time) const {
    const double place = (time - now_.start) / step();
    const double nearest = std::round(place);
    constexpr double most = 9e15;
    if (!(std::abs(place - nearest) <= tolerance + rounding_of(time) / step()) ||
        std::abs(nearest) > most) {
        refuse("The communication point " + shown(time) +
               " s is no sampling instant: points must be " + shown(now_.start) +
               " s plus a multiple of the period, " + shown(step()) + " s.");
    }
    return static_cast<std::int64_t>(nearest);
}

void Component::advance_discrete(double time, double end) {
    const std::int64_t first = instant(time);
    const std::int64_t last = instant(end);
    if (first != monitor_->samples()) {
        refuse("The step begins at " + shown(time) + " s, but the last one ended at " +
               shown(now_.reached) + " s.");
    }
    if (last - first > longest_step) {
        refuse("The step from " + shown(time) + " s to " + shown(end) + " s takes " +
               std::to_string(last - first) + " samples: make steps of at most " +
               std::to_string(longest_step) + " samples.");
    }
    std::vector<rtamt_value> known(is_early() ? monitor_->program().outputs.size()
                                              : 2 * now_.outcomes.size());
    monitor_->hold(now_.inputs, static_cast<std::size_t>(last - first), known);
    if (is_early()) return report_bounds(known);
    for (std::size_t i = 0; i < now_.outcomes.size(); ++i) {
        if (known[2 * i].known == 0) continue;
        const std::int64_t until = *monitor_->runner().known_until(2 * i);
        now_.outcomes[i] = {.robustness = known[2 * i].value,
                            .verdict = known[2 * i + 1].value,
                            .since = now_.start + static_cast<double>(until) * step(),
                            .known = true};
    }
}

void Component::report_bounds(std::span<const rtamt_value> known) noexcept {
    Outcome& outcome = now_.outcomes.front();
    outcome.known = known[2].known != 0;
    outcome.robustness = known[0].value;
    outcome.upper = known[1].value;
    outcome.verdict = known[2].value;
    outcome.since = outcome.known ? now_.start + known[3].value : 0.0;
}

// The tick of a time, as Python callers' times are counted; nothing where it is too far from 0.
std::optional<std::int64_t> Component::tick_of(double time) const noexcept {
    const Metadata& metadata = monitor_->metadata();
    const auto rate = static_cast<double>(metadata.denominator);
    if (metadata.numerator == 1) return ticks::tick_of(time, rate);
    const double tick = std::nearbyint(time * rate / static_cast<double>(metadata.numerator));
    return std::abs(tick) < ticks::farthest ? std::optional(static_cast<std::int64_t>(tick))
                                            : std::nullopt;
}

double Component::seconds_of(std::int64_t tick) const noexcept {
    const Metadata& metadata = monitor_->metadata();
    if (metadata.numerator == 1) return ticks::seconds_of(tick, metadata.denominator);
    return static_cast<double>(tick) * static_cast<double>(metadata.numerator) /
           static_cast<double>(metadata.denominator);
}

void Component::advance_dense(double time) {
    if (std::abs(time - now_.reached) > step() + rounding_of(time)) {
        refuse("The step begins at " + shown(time) + " s, but the last one ended at " +
               shown(now_.reached) + " s.");
    }
    const auto tick = tick_of(time);
    if (!tick) {
        refuse("The communication point " + shown(time) + " s is too far from 0 for ticks of " +
               shown(step()) + " s.");
    }
    std::vector<rtamt_sample> samples;
    samples.reserve(now_.inputs.size());
    for (std::uint32_t input = 0; input < now_.inputs.size(); ++input)
        samples.push_back({*tick, now_.inputs[input], input});
    monitor_->push(samples);
    for (std::size_t i = 0; i < now_.outcomes.size(); ++i) {
        Outcome& outcome = now_.outcomes[i];
        const dense::Events robustness = monitor_->runner().last_output(2 * i);
        const dense::Events verdict = monitor_->runner().last_output(2 * i + 1);
        if (robustness.count != 0) outcome.robustness = robustness.values[robustness.count - 1];
        if (verdict.count != 0) outcome.verdict = verdict.values[verdict.count - 1];
        if (const auto until = monitor_->runner().known_until(2 * i)) {
            outcome.known = true;
            outcome.since = seconds_of(*until);
        }
    }
}

// ---- variables ----------------------------------------------------------------------------------

double Component::real(std::uint32_t reference) const {
    if (reference < outputs()) return now_.inputs[reference];
    if (is_output(reference)) {
        const Output place = output_of(reference - outputs(), is_early());
        if (place == Output::robustness || place == Output::lower) {
            return outcome(reference).robustness;
        }
        if (place == Output::upper) return outcome(reference).upper;
        if (place == Output::since) return outcome(reference).since;
    } else {
        const std::uint32_t place = reference - parameters();
        const std::size_t count = monitor_->metadata().parameters.size();
        if (place < count) return monitor_->parameter(place);
        if (place == count) return now_.reached; // time, which FMI 3.0 has as a variable
    }
    refuse("There is no real variable with the reference " + std::to_string(reference) + ".");
}

std::int64_t Component::integer(std::uint32_t reference) const {
    constexpr double most = 9e15;
    if (is_settable(reference)) {
        const double value = real(reference);
        if (value == std::trunc(value) && std::abs(value) < most) {
            return static_cast<std::int64_t>(value);
        }
    }
    if (!is_output(reference) || output_of(reference - outputs(), is_early()) != Output::verdict) {
        refuse("There is no integer variable with the reference " + std::to_string(reference) +
               ".");
    }
    const double verdict = outcome(reference).verdict;
    return verdict > 0.0 ? 1 : verdict < 0.0 ? -1 : 0;
}

std::int32_t Component::integer32(std::uint32_t reference) const {
    const std::int64_t value = integer(reference);
    if (!std::in_range<std::int32_t>(value)) {
        refuse("The variable with the reference " + std::to_string(reference) + " is " +
               std::to_string(value) + ", which does not fit into 32 bits.");
    }
    return static_cast<std::int32_t>(value);
}

bool Component::boolean(std::uint32_t reference) const {
    if (is_settable(reference)) return real(reference) != 0.0;
    if (!is_output(reference) || output_of(reference - outputs(), is_early()) != Output::known) {
        refuse("There is no Boolean variable with the reference " + std::to_string(reference) +
               ".");
    }
    return outcome(reference).known;
}

void Component::set(std::span<const std::uint32_t> references, std::span<const double> values) {
    for (std::size_t i = 0; i < references.size(); ++i)
        check_set(references[i], values[i]);
    for (std::size_t i = 0; i < references.size(); ++i) {
        if (references[i] < outputs()) {
            now_.inputs[references[i]] = values[i];
        } else {
            monitor_->set_parameter(references[i] - parameters(), values[i]);
        }
    }
}

void Component::check_set(std::uint32_t reference, double value) const {
    if (reference < outputs()) return; // a wrong value is refused when it becomes a sample
    const std::uint32_t first = parameters();
    if (!is_settable(reference)) {
        refuse("The variable with the reference " + std::to_string(reference) + " cannot be set.");
    }
    if (now_.phase != Phase::created && now_.phase != Phase::initialising) {
        refuse("The parameter '" + monitor_->metadata().parameters[reference - first].name +
               "' can only be set before the end of the initialisation.");
    }
    monitor_->check_parameter(reference - first, value);
}

// ---- state --------------------------------------------------------------------------------------

void Component::Now::transfer(Snapshot& snapshot) {
    auto number = static_cast<std::uint8_t>(phase);
    snapshot.item(number);
    snapshot.require(number <= static_cast<std::uint8_t>(Phase::initialising));
    phase = static_cast<Phase>(number);
    for (double* value : {&start, &reached})
        snapshot.item(*value);
    snapshot.require(std::isfinite(start) && std::isfinite(reached));
    for (Outcome& each : outcomes) {
        for (double* value : {&each.robustness, &each.upper, &each.verdict, &each.since})
            snapshot.item(*value);
        snapshot.item(each.known);
    }
    snapshot.values(inputs.data(), inputs.size());
}

// What is not in the monitor, its checksum, then the monitor, which has its own.
std::vector<std::uint8_t> Component::save() {
    Snapshot snapshot;
    now_.transfer(snapshot);
    std::vector<std::uint8_t> state = snapshot.bytes();
    const std::uint32_t sum = crc32(state);
    for (unsigned shift = 0; shift < 32; shift += 8)
        state.push_back(static_cast<std::uint8_t>(sum >> shift));
    const std::vector<std::uint8_t> inside = monitor_->save();
    state.insert(state.end(), inside.begin(), inside.end());
    return state;
}

void Component::restore(std::span<const std::uint8_t> state) {
    Snapshot measure;
    now_.transfer(measure);
    const std::size_t outside = measure.bytes().size();
    if (state.size() < outside + checksum_size ||
        Reader(state.subspan(outside)).take<std::uint32_t>() != crc32(state.first(outside))) {
        refuse("This is not a state of this unit, or it was damaged on the way.");
    }
    Now then = fresh();
    Snapshot snapshot(state.first(outside));
    then.transfer(snapshot);
    monitor_->restore(state.subspan(outside + checksum_size));
    now_ = std::move(then);
}

} // namespace rtamt::fmi
