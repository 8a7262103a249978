#include "monitor.hpp"

#include "recording.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace rtamt::python {

using discrete::Failure;
using discrete::Outcome;

namespace {

// How many samples a value may come late, and the last one: those that a caller may have to name.
[[nodiscard]] std::size_t history_of(const Program& program) noexcept {
    return static_cast<std::size_t>(program.latest()) + 1;
}

// What a list holds, kept alive where the list may change meanwhile: reading numbers that are not
// plain runs Python code, and without a GIL other threads run at any time.
template <bool plain>
[[nodiscard]] auto held(PyObject* object) noexcept {
#ifdef NB_FREE_THREADED
    constexpr bool stays = false;
#else
    constexpr bool stays = plain;
#endif
    if constexpr (stays) {
        return nb::handle(object);
    } else {
        return nb::borrow(object);
    }
}

} // namespace

Monitor::Monitor(Program program, const std::vector<nb::str>& names, double period,
                 double tolerance, bool strict, const nb::object& ignored, const nb::dict& types,
                 std::shared_ptr<Calls> calls, Exceptions exceptions)
    : calls_(std::move(calls)), executor_(std::move(program)),
      clock_(period, tolerance, strict, history_of(executor_.program())),
      names_(names, executor_.program().inputs, ignored, types), exceptions_(std::move(exceptions)),
      usage_(exceptions_.refused, exceptions_.in_use), row_(names.size()),
      given_(std::make_unique<bool[]>(names.size())), previous_(names.size()) {
    if (!(period > 0.0) || !std::isfinite(period) || !(tolerance >= 0.0)) {
        throw std::invalid_argument(
            "The period must be positive and finite, the tolerance 0 or more.");
    }
}

// ---- one sample ---------------------------------------------------------------------------------

// Has `read(numbers, time, places)` read a sample, which returns what is wrong, or null. Plain
// numbers, which run no Python code, are read into row_ at once. `keeps`: an input that is left out
// keeps its value.
template <bool timed, bool keeps, class Read>
PyObject* Monitor::sample(const Read& read) noexcept {
    if (!ready()) return nullptr;
    double time = 0.0;
    const Places places = this->places();
    const bool first = executor_.samples() == 0;
    if constexpr (keeps) {
        if (first) {
            places.clear();
        } else {
            std::ranges::copy(previous_, row_.begin());
        }
    }
    const char* wrong = usage_.briefly([&] { return read(PlainNumbers{}, time, places); });
    if (wrong != nullptr) [[unlikely]] {
        return wrong == not_plain ? sample_carefully<timed, keeps>(read) : usage_.refuse(wrong);
    }
    if (timed && !clock_.accepts(time)) return usage_.refuse("time");
    if (keeps && first && !places.whole()) return usage_.refuse("names");
    return take<timed>(time);
}

// All other numbers are read into a row of this call alone, and the monitor is looked at when all
// of them have been read: only then is it certain what its state is.
template <bool timed, bool keeps, class Read>
PyObject* Monitor::sample_carefully(const Read& read) noexcept {
    double time = 0.0;
    Row row(row_.size());
    if (!row) return PyErr_NoMemory();
    const Places places = row.places();
    if (const char* wrong = read(numbers_, time, places)) return usage_.refuse(wrong);
    if (!ready()) return nullptr;
    if (keeps && executor_.samples() != 0) row.complete(previous_);
    if (timed && !clock_.accepts(time)) return usage_.refuse("time");
    if (!places.whole()) return usage_.refuse("names");
    std::copy_n(places.values, places.size, row_.begin());
    return take<timed>(time);
}

template <class Values>
PyObject* Monitor::update(PyObject* time, const Values& values) noexcept {
    return sample<true, false>(
        [&](const auto& numbers, double& t, const Places& places) -> const char* {
            if (!numbers.read(time, t)) return no_number(numbers, "time");
            if (std::fabs(t) >= implausible) return "time";
            if (values.count() != names_.count()) return "names";
            std::size_t guess = 0;
            return values.each([&](PyObject* name, PyObject* value) -> const char* {
                const auto index = names_.place(name, guess++, numbers.plain);
                if (!index) return no_name(numbers, name);
                places.given[*index] = true;
                return names_.read(numbers, *index, value, places.values[*index])
                           ? nullptr
                           : no_number(numbers, "value");
            });
        });
}

template PyObject* Monitor::update(PyObject* time, const Named& values) noexcept;
template PyObject* Monitor::update(PyObject* time, const InDict& values) noexcept;

PyObject* Monitor::update_pairs(PyObject* time, PyObject* pairs) noexcept {
    return sample<true, true>(
        [&](const auto& numbers, double& t, const Places& places) -> const char* {
            if (!numbers.read(time, t)) return no_number(numbers, "time");
            constexpr bool plain = std::remove_cvref_t<decltype(numbers)>::plain;
            if (!PyList_Check(pairs) && !PyTuple_Check(pairs)) return "pairs";
            std::size_t guess = 0;
            for (Py_ssize_t i = 0; i < sequence_size(pairs); ++i) {
                const auto pair = held<plain>(sequence_item(pairs, i));
                const nb::ft_object_guard guard(pair);
                if ((!PyTuple_Check(pair.ptr()) && !PyList_Check(pair.ptr())) ||
                    sequence_size(pair.ptr()) != 2) {
                    return "pairs";
                }
                const auto name = held<plain>(sequence_item(pair.ptr(), 0));
                const auto value = held<plain>(sequence_item(pair.ptr(), 1));
                if (const auto index = names_.place(name.ptr(), guess, plain)) {
                    places.given[*index] = true;
                    if (!names_.read(numbers, *index, value.ptr(), places.values[*index])) {
                        return no_number(numbers, "value");
                    }
                    guess = *index + 1;
                } else if (!names_.ignored(name.ptr(), plain)) {
                    return no_name(numbers, name.ptr());
                }
            }
            return nullptr;
        });
}

PyObject* Monitor::step(std::span<PyObject* const> values) noexcept {
    if (values.size() != names_.count()) return ready() ? usage_.refuse("count") : nullptr;
    return sample<false, false>(
        [&](const auto& numbers, double& /*time*/, const Places& places) -> const char* {
            for (std::size_t i = 0; i < values.size(); ++i) {
                places.given[i] = true;
                if (!names_.read(numbers, i, values[i], places.values[i])) {
                    return no_number(numbers, "value");
                }
            }
            return nullptr;
        });
}

// Runs the sample in row_, a period after the last one if it has no time of its own; sets the clock
// once nothing can go wrong any more.
template <bool timed>
PyObject* Monitor::take(double time) noexcept {
    double value = 0.0;
    const Outcome outcome = usage_.briefly([&] { return executor_.step(row_.data(), value); });
    if (outcome == Outcome::failed) [[unlikely]] {
        const Failure& failure = executor_.failure();
        const bool before = failure.sample < executor_.samples();
        set_undefined(exceptions_, *calls_, failure.instruction, failure.sample, failure.fault,
                      before  ? time_of(failure.sample, std::nullopt)
                      : timed ? time
                              : clock_.upcoming(0));
        return nullptr;
    }
    std::swap(row_, previous_);
    timed ? clock_.advance(time) : clock_.tick(1);
    if (outcome == Outcome::known) return PyFloat_FromDouble(value);
    Py_RETURN_NONE;
}

// The time of a sample that the last history_of() or the ones that are being taken have; those come
// at the given times, or a period apart.
double Monitor::time_of(std::int64_t sample, std::optional<std::span<const double>> times) const {
    const auto index = static_cast<std::size_t>(sample);
    const std::size_t so_far = clock_.timestamps().count();
    if (index < so_far) return clock_.timestamps().at(index);
    return times ? (*times)[index - so_far] : clock_.upcoming(index - so_far);
}

// ---- many samples -------------------------------------------------------------------------------

std::vector<Result> Monitor::push(const std::optional<Column>& times,
                                  const std::vector<Column>& columns,
                                  std::optional<std::int64_t> after) {
    usage_.require_idle();
    if (executor_.finished()) {
        (void)usage_.refuse("finished");
        throw nb::python_error();
    }
    usage_.require(after.value_or(executor_.samples()) == executor_.samples());
    std::size_t count = times ? times->shape(0) : 0;
    if (!times && !columns.empty()) count = columns.front().shape(0);
    const auto pointers = pointers_of(columns, names_.count(), count);
    Results results;
    for (std::size_t i = 0; i < executor_.program().outputs.size(); ++i) {
        results.add(executor_.known(i, count));
    }
    std::optional<std::span<const double>> timestamps;
    if (times) timestamps.emplace(times->data(), count);
    push(timestamps, pointers, count, results.pointers());
    return results.hand_over();
}

void Monitor::push(std::optional<std::span<const double>> times,
                   std::span<const double* const> columns, std::size_t count,
                   std::span<double* const> outputs) {
    const auto failure =
        usage_.exclusively(count, [&] { return executor_.push(columns, count, outputs); });
    if (failure) {
        raise_undefined(exceptions_, *calls_, failure->instruction, failure->sample, failure->fault,
                        time_of(failure->sample, times));
    }
    if (times) {
        for (const double time : *times)
            clock_.advance(time);
    } else {
        clock_.tick(count);
    }
    if (count == 0) return;
    for (std::size_t i = 0; i < columns.size(); ++i)
        previous_[i] = columns[i][count - 1];
}

bool Monitor::accepts(const Column& times, const std::vector<Column>& columns) const {
    usage_.require_idle();
    const std::span<const double> seconds(times.data(), times.shape(0));
    const auto last = clock_.timestamps().last();
    return !seconds.empty() && names_.plain() && ordered(seconds, last) &&
           regular(seconds, last, clock_.period(), clock_.tolerance()) &&
           std::ranges::all_of(columns, [](const Column& column) {
               return all_numbers({column.data(), column.shape(0)});
           });
}

nb::object Monitor::take_columns(const nb::handle& data, const nb::handle& time) {
    usage_.require_idle();
    if (executor_.finished() || !names_.plain()) return nb::none();
    const auto given = GivenColumns::of(numpy_, data, names_.all(), time);
    if (!given) return nb::none();
    const std::size_t count = given->count;
    const std::int64_t so_far = executor_.samples();
    const NewArray timestamps = numpy_.make(count);
    const std::span<double> times(timestamps.values(), count);
    std::optional<std::span<const double>> stamps;
    if (given->times) {
        const auto last = clock_.timestamps().last();
        if (!given->times->copy(times.data()) || !ordered(times, last) ||
            !regular(times, last, clock_.period(), clock_.tolerance())) {
            return nb::none();
        }
        stamps = times;
    } else {
        for (std::size_t i = 0; i < count; ++i)
            times[i] = clock_.upcoming(i);
    }
    const std::size_t width = given->columns.size();
    const auto values = std::make_unique_for_overwrite<double[]>(width * count);
    std::vector<const double*> columns;
    columns.reserve(width);
    for (const Given& column : given->columns) {
        double* copy = values.get() + columns.size() * count;
        if (!column.copy(copy)) return nb::none();
        columns.push_back(copy);
    }

    const Program& program = executor_.program();
    std::vector<NewArray> made;
    std::vector<double*> outputs;
    nb::list news;
    for (std::size_t i = 0; i < program.outputs.size(); ++i) {
        const std::size_t known = executor_.known(i, count);
        outputs.push_back(made.emplace_back(numpy_.make(known)).values());
        const std::int64_t lag = program.instructions[program.outputs[i]].lag;
        nb::object known_at = timestamps.array;
        if (lag != 0) {
            const NewArray late = numpy_.make(known);
            const std::int64_t first = std::max<std::int64_t>(so_far - lag, 0);
            for (std::size_t k = 0; k < known; ++k)
                late.values()[k] = time_of(first + static_cast<std::int64_t>(k), times);
            known_at = late.array;
        }
        news.append(nb::make_tuple(known_at, made.back().array));
    }
    usage_.require_idle(); // an allocation may have run Python code
    usage_.require(executor_.samples() == so_far && !executor_.finished());
    push(stamps, columns, count, outputs);
    return nb::make_tuple(executor_.samples(), news);
}

std::vector<Result> Monitor::finish() {
    usage_.require_idle();
    Results results;
    for (std::size_t i = 0; i < executor_.program().outputs.size(); ++i) {
        results.add(executor_.remaining(i));
    }
    const auto failure = usage_.exclusively(history_of(executor_.program()),
                                            [&] { return executor_.finish(results.pointers()); });
    if (failure) {
        raise_undefined(exceptions_, *calls_, failure->instruction, failure->sample, failure->fault,
                        time_of(failure->sample, std::nullopt));
    }
    return results.hand_over();
}

void Monitor::reset() {
    usage_.require_idle();
    executor_.reset();
    clock_.reset();
    std::ranges::fill(previous_, 0.0);
}

nb::bytes Monitor::state() {
    usage_.require_idle();
    Snapshot snapshot;
    transfer(snapshot);
    return bytes_of(snapshot);
}

void Monitor::restore(const nb::bytes& state) {
    usage_.require_idle();
    Snapshot snapshot = snapshot_of(state);
    transfer(snapshot);
    snapshot.end();
}

void Monitor::transfer(Snapshot& snapshot) {
    executor_.transfer(snapshot);
    clock_.transfer(snapshot);
    snapshot.require(clock_.timestamps().count() == static_cast<std::size_t>(executor_.samples()));
    snapshot.values(previous_.data(), previous_.size());
}

std::int64_t Monitor::samples() const {
    usage_.require_idle();
    return executor_.samples();
}

std::uint64_t Monitor::violations() const {
    usage_.require_idle();
    return clock_.violations();
}

std::optional<double> Monitor::last_time() const {
    usage_.require_idle();
    return clock_.timestamps().last();
}

std::size_t Monitor::state_bytes() const {
    usage_.require_idle();
    return executor_.state_bytes() + clock_.timestamps().bytes();
}

std::optional<double> Monitor::last(std::uint32_t instruction) const {
    usage_.require_idle();
    if (instruction >= executor_.program().instructions.size()) {
        throw std::out_of_range("There is no instruction " + std::to_string(instruction) + ".");
    }
    return executor_.last(instruction);
}

std::optional<double> Monitor::latest(std::size_t output) const {
    usage_.require_idle();
    const Program& program = executor_.program();
    if (output >= program.outputs.size()) {
        throw std::out_of_range("There is no output " + std::to_string(output) + ".");
    }
    const std::uint32_t instruction = program.outputs[output];
    if (executor_.samples() <= program.instructions[instruction].lag) return std::nullopt;
    return executor_.last(instruction);
}

Result Monitor::recent(std::size_t count) const {
    usage_.require_idle();
    const std::size_t available = clock_.timestamps().available();
    if (count > available) {
        throw std::invalid_argument("Only the times of the last " + std::to_string(available) +
                                    " samples are remembered.");
    }
    Results results;
    results.add(count);
    clock_.timestamps().copy(count, results.pointers().front());
    return std::move(results.hand_over().front());
}

} // namespace rtamt::python
