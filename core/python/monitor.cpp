#include "monitor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace rtamt::python {

using discrete::Failure;
using discrete::Outcome;

namespace {

// No input has this value, so it marks those that have none yet.
constexpr double missing = std::numeric_limits<double>::quiet_NaN();

// How many samples a value may come late, and the last one: those that a caller may have to name.
[[nodiscard]] std::size_t history_of(const Program& program) noexcept {
    return static_cast<std::size_t>(program.latest()) + 1;
}

} // namespace

Monitor::Monitor(Program program, const std::vector<nb::str>& names, double period,
                 double tolerance, bool strict, const nb::object& ignored,
                 std::shared_ptr<Calls> calls, Exceptions exceptions)
    : calls_(std::move(calls)), executor_(std::move(program)),
      clock_(period, tolerance, strict, history_of(executor_.program())),
      names_(names, executor_.program().inputs, ignored), exceptions_(std::move(exceptions)),
      gate_(exceptions_.refused), row_(names.size()), previous_(names.size(), missing) {
    if (!(period > 0.0) || !std::isfinite(period) || !(tolerance >= 0.0)) {
        throw std::invalid_argument(
            "The period must be positive and finite, the tolerance 0 or more.");
    }
}

// ---- one sample ---------------------------------------------------------------------------------

template <class Values>
PyObject* Monitor::update(PyObject* time, const Values& values) noexcept {
    double t = 0.0;
    if (!ready()) return nullptr;
    if (!numbers_.read(time, t) || !clock_.accepts(t)) return gate_.refuse("time");
    if (values.count() != names_.count()) return gate_.refuse("names");
    std::size_t guess = 0;
    const char* wrong = values.each([&](PyObject* name, PyObject* value) -> const char* {
        const auto index = names_.place(name, guess++);
        if (!index) return "names";
        return numbers_.read(value, row_[*index]) ? nullptr : "value";
    });
    if (wrong != nullptr) return gate_.refuse(wrong);
    return take([&] { clock_.advance(t); });
}

template PyObject* Monitor::update(PyObject* time, const Named& values) noexcept;
template PyObject* Monitor::update(PyObject* time, const InDict& values) noexcept;

PyObject* Monitor::update_pairs(PyObject* time, PyObject* pairs) noexcept {
    double t = 0.0;
    if (!ready()) return nullptr;
    if (!numbers_.read(time, t) || !clock_.accepts(t)) return gate_.refuse("time");
    if (!PyList_Check(pairs) && !PyTuple_Check(pairs)) return gate_.refuse("pairs");
    std::ranges::copy(previous_, row_.begin());
    std::size_t guess = 0;
    for (Py_ssize_t i = 0; i < PySequence_Fast_GET_SIZE(pairs); ++i) {
        PyObject* pair = PySequence_Fast_GET_ITEM(pairs, i);
        if ((!PyTuple_Check(pair) && !PyList_Check(pair)) || PySequence_Fast_GET_SIZE(pair) != 2) {
            return gate_.refuse("pairs");
        }
        PyObject* name = PySequence_Fast_GET_ITEM(pair, 0);
        PyObject* value = PySequence_Fast_GET_ITEM(pair, 1);
        if (const auto index = names_.place(name, guess)) {
            if (!numbers_.read(value, row_[*index])) return gate_.refuse("value");
            guess = *index + 1;
            continue;
        }
        if (!names_.ignored(name)) return gate_.refuse("names");
    }
    for (const double value : row_) {
        if (std::isnan(value)) return gate_.refuse("names");
    }
    return take([&] { clock_.advance(t); });
}

PyObject* Monitor::step(std::span<PyObject* const> values) noexcept {
    if (!ready()) return nullptr;
    if (values.size() != row_.size()) return gate_.refuse("count");
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (!numbers_.read(values[i], row_[i])) return gate_.refuse("value");
    }
    return take([&] { clock_.tick(1); });
}

// Runs the sample in row_; `accepted` sets the clock once nothing can go wrong any more.
template <class Accepted>
PyObject* Monitor::take(Accepted&& accepted) noexcept {
    double value = 0.0;
    const Outcome outcome = gate_.briefly([&] { return executor_.step(row_.data(), value); });
    if (outcome == Outcome::failed) [[unlikely]] {
        return fail();
    }
    std::swap(row_, previous_);
    std::forward<Accepted>(accepted)();
    if (outcome == Outcome::known) return PyFloat_FromDouble(value);
    Py_RETURN_NONE;
}

PyObject* Monitor::fail() const noexcept {
    const Failure& failure = executor_.failure();
    set_undefined(exceptions_, *calls_, failure.instruction, failure.sample, failure.fault);
    return nullptr;
}

// ---- many samples -------------------------------------------------------------------------------

std::vector<Result> Monitor::push(const std::optional<Column>& times,
                                  const std::vector<Column>& columns) {
    gate_.require_idle();
    if (executor_.finished()) {
        (void)gate_.refuse("finished");
        throw nb::python_error();
    }
    std::size_t count = times ? times->shape(0) : 0;
    if (!times && !columns.empty()) count = columns.front().shape(0);
    const auto pointers = pointers_of(columns, names_.count(), count);
    Results results;
    for (std::size_t i = 0; i < executor_.program().outputs.size(); ++i) {
        results.add(executor_.known(i, count));
    }
    const auto failure = gate_.exclusively(
        count, [&] { return executor_.push(pointers, count, results.pointers()); });
    if (failure) {
        raise_undefined(exceptions_, *calls_, failure->instruction, failure->sample,
                        failure->fault);
    }
    if (times) {
        for (std::size_t i = 0; i < count; ++i)
            clock_.advance(times->data()[i]);
    } else {
        clock_.tick(count);
    }
    if (count > 0) {
        for (std::size_t i = 0; i < pointers.size(); ++i)
            previous_[i] = pointers[i][count - 1];
    }
    return results.hand_over();
}

std::vector<Result> Monitor::finish() {
    gate_.require_idle();
    Results results;
    for (std::size_t i = 0; i < executor_.program().outputs.size(); ++i) {
        results.add(executor_.remaining(i));
    }
    const auto failure = gate_.exclusively(history_of(executor_.program()),
                                           [&] { return executor_.finish(results.pointers()); });
    if (failure) {
        raise_undefined(exceptions_, *calls_, failure->instruction, failure->sample,
                        failure->fault);
    }
    return results.hand_over();
}

void Monitor::reset() {
    gate_.require_idle();
    executor_.reset();
    clock_.reset();
    std::ranges::fill(previous_, missing);
}

nb::bytes Monitor::state() {
    gate_.require_idle();
    Snapshot snapshot;
    transfer(snapshot);
    return bytes_of(snapshot);
}

void Monitor::restore(const nb::bytes& state) {
    gate_.require_idle();
    Snapshot snapshot = snapshot_of(state);
    transfer(snapshot);
    snapshot.end();
}

void Monitor::transfer(Snapshot& snapshot) {
    executor_.transfer(snapshot);
    clock_.transfer(snapshot);
    snapshot.cells(previous_.data(), previous_.size());
}

double Monitor::last(std::uint32_t instruction) const {
    gate_.require_idle();
    if (instruction >= executor_.program().instructions.size()) {
        throw std::out_of_range("There is no instruction " + std::to_string(instruction) + ".");
    }
    return executor_.last(instruction);
}

std::optional<double> Monitor::latest(std::size_t output) const {
    gate_.require_idle();
    const Program& program = executor_.program();
    if (output >= program.outputs.size()) {
        throw std::out_of_range("There is no output " + std::to_string(output) + ".");
    }
    const std::uint32_t instruction = program.outputs[output];
    if (executor_.samples() <= program.instructions[instruction].lag) return std::nullopt;
    return executor_.last(instruction);
}

Result Monitor::recent(std::size_t count) const {
    gate_.require_idle();
    const std::size_t available = clock_.stamps().available();
    if (count > available) {
        throw std::invalid_argument("Only the times of the last " + std::to_string(available) +
                                    " samples are remembered.");
    }
    Results results;
    results.add(count);
    clock_.stamps().copy(count, results.pointers().front());
    return std::move(results.hand_over().front());
}

} // namespace rtamt::python
