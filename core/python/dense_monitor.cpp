#include "dense_monitor.hpp"

#include "ticks.hpp"

#include <algorithm>
#include <cstring>
#include <initializer_list>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>

namespace rtamt::python {

using dense::EventList;
using dense::Events;
using dense::Failure;

namespace {

template <class Item>
[[nodiscard]] nb::ndarray<nb::numpy, Item, nb::ndim<1>> array(Item* items, std::size_t count,
                                                              const nb::capsule& owner) {
    static Item none{}; // an empty array points somewhere, too
    return {items == nullptr ? &none : items, std::initializer_list<std::size_t>{count}, owner};
}

// How many samples a call brings.
[[nodiscard]] std::size_t samples(const std::vector<Events>& inputs) noexcept {
    std::size_t count = 0;
    for (const Events& events : inputs)
        count += events.count;
    return count;
}

} // namespace

std::vector<Events> events_of(const std::vector<EventColumn>& columns, std::size_t inputs) {
    if (columns.size() != inputs) {
        throw std::invalid_argument("Got " + std::to_string(columns.size()) +
                                    " signals for a program with " + std::to_string(inputs) +
                                    " inputs.");
    }
    std::vector<Events> events;
    events.reserve(columns.size());
    for (const auto& [times, values] : columns) {
        if (times.shape(0) != values.shape(0)) {
            throw std::invalid_argument("A signal has " + std::to_string(times.shape(0)) +
                                        " times and " + std::to_string(values.shape(0)) +
                                        " values.");
        }
        events.push_back({times.data(), values.data(), times.shape(0)});
    }
    return events;
}

nb::tuple hand_over(EventList& list) {
    auto kept = std::make_unique<EventList>();
    std::swap(*kept, list);
    const nb::capsule owner(kept.get(),
                            [](void* memory) noexcept { delete static_cast<EventList*>(memory); });
    EventList* events = kept.release();
    return nb::make_tuple(array(events->times(), events->count(), owner),
                          array(events->values(), events->count(), owner));
}

nb::list hand_over(std::vector<EventList>& lists) {
    nb::list result;
    for (EventList& list : lists)
        result.append(hand_over(list));
    return result;
}

DenseMonitor::DenseMonitor(Program program, const std::vector<nb::str>& names,
                           const nb::object& ignored, const nb::dict& types,
                           std::shared_ptr<Calls> calls, Exceptions exceptions)
    : calls_(std::move(calls)), executor_(std::move(program)),
      names_(names, executor_.program().inputs, ignored, types), exceptions_(std::move(exceptions)),
      usage_(exceptions_.refused, exceptions_.in_use), row_(names.size()),
      given_(std::make_unique<bool[]>(names.size())), events_(names.size()),
      results_(executor_.program().outputs.size()), spare_(results_.size()),
      until_(results_.size()), counts_(names.size()) {}

void DenseMonitor::set_time_scale(const nb::type_object& signal, const nb::object& scale,
                                  double rate, bool whole) {
    usage_.require_idle();
    signals_.emplace(signal, scale);
    rate_ = rate;
    whole_ = whole;
    nothing_ = nb::steal(signals_->make({}));
    if (!nothing_.is_valid()) throw nb::python_error();
    has_time_scale_ = true;
}

// ---- one instant --------------------------------------------------------------------------------

template <class Values>
PyObject* DenseMonitor::update(PyObject* time, const Values& values) noexcept {
    if (!ready() || !read(time, values)) return nullptr;
    for (EventList& list : spare_)
        list.resize(0);
    try {
        const auto failure = usage_.briefly([&] { return executor_.push(events_, spare_); });
        if (failure) return fail(*failure);
        std::swap(results_, spare_);
        for (std::size_t input = 0; input < events_.size(); ++input)
            counts_[input] += static_cast<std::int64_t>(events_[input].count);
        close();
    } catch (const std::bad_alloc&) {
        return PyErr_NoMemory();
    }
    return result();
}

template PyObject* DenseMonitor::update(PyObject* time, const Named& values) noexcept;
template PyObject* DenseMonitor::update(PyObject* time, const InDict& values) noexcept;

// Puts a point at the last instant that is known of each output, unless it was reported before.
void DenseMonitor::close() {
    for (std::size_t output = 0; output < results_.size(); ++output) {
        const auto until = executor_.known_until(output);
        if (!until || until_[output] == until) continue;
        until_[output] = until;
        EventList& list = results_[output];
        if (list.count() == 0 || list.times()[list.count() - 1] != *until) {
            list.append(*until, executor_.value(output));
        }
    }
}

PyObject* DenseMonitor::fail(const Failure& failure) const noexcept {
    set_undefined(exceptions_, *calls_, failure.instruction, failure.time, failure.fault);
    return nullptr;
}

// Reads an instant, after which samples may come; if not, a Python exception is set. Plain numbers,
// which run no Python code, are read into row_ at once. All others are read into a row of this call
// alone, and the monitor is looked at when all of them have been read: only then is it certain what
// its state is.
template <class Values>
bool DenseMonitor::read(PyObject* time, const Values& values) noexcept {
    const bool ready_before = has_time_scale_;
    const double rate = rate_;
    const bool whole = whole_;
    const auto tick = ready_before ? tick_of(time, rate, whole) : std::nullopt;
    if (!tick) return usage_.refuse("time") != nullptr;
    const Places own = places();
    own.clear();
    // A time of any other kind may have run Python code.
    const bool plain = PyFloat_Check(time) || PyLong_CheckExact(time);
    const char* wrong = not_plain;
    if (plain) {
        wrong = usage_.briefly([&] { return read_values(values, PlainNumbers{}, own); });
    }
    if (wrong != nullptr && wrong != not_plain) return usage_.refuse(wrong) != nullptr;
    if (wrong != nullptr) {
        Row row(row_.size());
        if (!row) return PyErr_NoMemory() != nullptr;
        const Places read = row.places();
        if (const char* still = read_values(values, numbers_, read)) {
            return usage_.refuse(still) != nullptr;
        }
        if (!ready()) return false;
        std::copy_n(read.values, read.size, own.values);
        std::copy_n(read.given, read.size, own.given);
    }
    time_ = *tick;
    return (ready_before == has_time_scale_ && rate == rate_ && whole == whole_ &&
            bind_buffers()) ||
           usage_.refuse("time") != nullptr;
}

// Returns what is wrong, or null.
template <class Values, class Numbers>
const char* DenseMonitor::read_values(const Values& values, const Numbers& numbers,
                                      const Places& places) const noexcept {
    std::size_t guess = 0;
    return values.each([&](PyObject* name, PyObject* value) -> const char* {
        const auto index = names_.place(name, guess, Numbers::plain);
        if (!index) {
            return names_.ignored(name, Numbers::plain) ? nullptr : no_name(numbers, name);
        }
        guess = *index + 1;
        places.given[*index] = true;
        return names_.read(numbers, *index, value, places.values[*index])
                   ? nullptr
                   : no_number(numbers, "value");
    });
}

// Makes events of the instant; returns whether it is in order.
bool DenseMonitor::bind_buffers() noexcept {
    if (time_ > executor_.last_possible()) return false;
    for (std::size_t input = 0; input < row_.size(); ++input) {
        events_[input] = {};
        if (!given_[input]) continue;
        if (time_ <= executor_.last_time(input).value_or(-dense::never - 1)) return false;
        events_[input] = {&time_, &row_[input], 1};
    }
    return true;
}

PyObject* DenseMonitor::result() const noexcept {
    const Events events = results_.front().view();
    return events.count == 0 ? nb::borrow(nothing_).release().ptr() : signals_->make(events);
}

// ---- many samples -------------------------------------------------------------------------------

nb::tuple DenseMonitor::push(const std::vector<EventColumn>& columns) {
    usage_.require_idle();
    if (!ready()) throw nb::python_error();
    const std::vector<Events> inputs = events_of(columns, names_.count());
    for (std::size_t i = 0; i < inputs.size(); ++i) {
        const Events& events = inputs[i];
        if (events.count == 0) continue;
        if (events.times[0] <= executor_.last_time(i).value_or(-dense::never - 1) ||
            events.times[events.count - 1] > executor_.last_possible()) {
            (void)usage_.refuse("time");
            throw nb::python_error();
        }
    }
    std::vector<EventList> results(results_.size());
    std::optional<Failure> failure;
    usage_.exclusively(samples(inputs), [&] { failure = executor_.push(inputs, results); });
    if (failure) {
        raise_undefined(exceptions_, *calls_, failure->instruction, failure->time, failure->fault);
    }
    for (std::size_t i = 0; i < inputs.size(); ++i)
        counts_[i] += static_cast<std::int64_t>(inputs[i].count);
    return take(results);
}

nb::tuple DenseMonitor::finish() {
    usage_.require_idle();
    std::vector<EventList> results(results_.size());
    std::optional<Failure> failure;
    usage_.exclusively(executor_.state_bytes(), [&] { failure = executor_.finish(results); });
    if (failure) {
        raise_undefined(exceptions_, *calls_, failure->instruction, failure->time, failure->fault);
    }
    return take(results);
}

nb::tuple DenseMonitor::take(std::vector<EventList>& results) {
    std::swap(results_, results);
    close();
    return hand_over(results_.front());
}

nb::tuple DenseMonitor::last_output(std::size_t output) const {
    usage_.require_idle();
    require_output(output);
    const Events events = results_[output].view();
    EventList copy;
    copy.append(events);
    return hand_over(copy);
}

nb::list DenseMonitor::points() const {
    usage_.require_idle();
    nb::list every;
    for (const EventList& list : results_) {
        const Events events = list.view();
        nb::list pairs;
        for (std::size_t i = 0; i < events.count; ++i)
            pairs.append(nb::make_tuple(events.times[i], events.values[i]));
        every.append(pairs);
    }
    return every;
}

void DenseMonitor::reset() {
    usage_.require_idle();
    executor_.reset();
    for (EventList& list : results_)
        list.resize(0);
    std::ranges::fill(until_, std::nullopt);
    std::ranges::fill(counts_, 0);
    has_time_scale_ = false;
}

nb::bytes DenseMonitor::state() {
    usage_.require_idle();
    Snapshot snapshot;
    transfer(snapshot);
    return bytes_of(snapshot);
}

void DenseMonitor::restore(const nb::bytes& state) {
    usage_.require_idle();
    Snapshot snapshot = snapshot_of(state);
    transfer(snapshot);
    snapshot.end();
}

void DenseMonitor::transfer(Snapshot& snapshot) {
    executor_.transfer(snapshot);
    snapshot.values(counts_.data(), counts_.size());
    for (const std::int64_t count : counts_)
        snapshot.require(count >= 0 && count < dense::never / 4);
    for (auto& until : until_)
        snapshot.item(until);
    for (EventList& list : results_)
        list.transfer(snapshot);
}

std::vector<std::int64_t> DenseMonitor::counts() const {
    usage_.require_idle();
    return counts_;
}

std::optional<std::int64_t> DenseMonitor::start() const {
    usage_.require_idle();
    return executor_.start();
}

std::optional<std::int64_t> DenseMonitor::known(std::size_t output) const {
    usage_.require_idle();
    require_output(output);
    return executor_.known_until(output);
}

std::vector<std::optional<std::int64_t>> DenseMonitor::last_times() const {
    usage_.require_idle();
    std::vector<std::optional<std::int64_t>> times;
    times.reserve(names_.count());
    for (std::size_t input = 0; input < names_.count(); ++input)
        times.push_back(executor_.last_time(input));
    return times;
}

std::int64_t DenseMonitor::last_possible() const {
    usage_.require_idle();
    return executor_.last_possible();
}

std::size_t DenseMonitor::state_bytes() const {
    usage_.require_idle();
    return executor_.state_bytes();
}

void DenseMonitor::require_output(std::size_t output) const {
    if (output >= results_.size()) {
        throw std::out_of_range("There is no output " + std::to_string(output) + ".");
    }
}

} // namespace rtamt::python
