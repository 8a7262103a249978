#include "dense_direct_evaluator.hpp"

#include "arrays.hpp"
#include "calls.hpp"
#include "offline.hpp"
#include "ticks.hpp"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace rtamt::python {

using dense::EventList;
using dense::Events;

namespace {

// The memory kept for the next recording is limited to this size.
constexpr std::size_t most_kept = std::size_t{1} << 16U;

[[nodiscard]] nb::object new_bytes(std::size_t count) {
    auto bytes = nb::steal(PyByteArray_FromStringAndSize(nullptr, static_cast<Py_ssize_t>(count)));
    if (!bytes.is_valid()) throw nb::python_error();
    return bytes;
}

// Where a column of items of 8 bytes begins.
template <class Item>
[[nodiscard]] Item* column(PyObject* bytes, std::size_t place) noexcept {
    return reinterpret_cast<Item*>(PyByteArray_AsString(bytes)) + place;
}

} // namespace

DenseDirectEvaluator::DenseDirectEvaluator(std::vector<nb::str> names, nb::str time, double rate,
                                           std::int64_t extra, const nb::list& stages,
                                           const nb::object& signal)
    : names_(std::move(names)), time_(std::move(time)), rate_(rate), extra_(extra),
      signal_(signal, {"_times", "_values"}) {
    for (const nb::handle each : stages) {
        const auto given = nb::cast<nb::tuple>(each);
        Stage stage{parse(nb::cast<nb::bytes>(given[0]), Domain::dense),
                    nb::cast<std::vector<std::size_t>>(given[1]),
                    {},
                    std::make_unique<std::atomic<dense::Executor*>>(nullptr)};
        for (const nb::tuple& scan : nb::cast<std::vector<nb::tuple>>(given[2])) {
            stage.scans.push_back(
                {nb::cast<std::string>(scan[0]), nb::cast<std::vector<std::size_t>>(scan[1])});
        }
        stages_.push_back(std::move(stage));
    }
    if (stages_.empty() || stages_.back().program.outputs.size() != 1) {
        throw std::invalid_argument("The last program of a plan has one output.");
    }
}

// Of each variable a tuple of times and values, or values at common times. Nothing for data of
// another form, or without samples.
std::optional<std::vector<DenseDirectEvaluator::Samples>>
DenseDirectEvaluator::samples_in(const nb::handle& data) const {
    if (!PyDict_CheckExact(data.ptr())) return std::nullopt;
    const nb::object shared = item_of(data, time_);
    std::vector<Samples> found;
    found.reserve(names_.size());
    for (const nb::str& name : names_) {
        if (shared.is_valid() && name.equal(time_)) return std::nullopt;
        nb::object given = item_of(data, name);
        if (!given.is_valid()) return std::nullopt;
        nb::object times = shared;
        if (!shared.is_valid()) {
            if (!PyTuple_CheckExact(given.ptr()) || tuple_size(given.ptr()) != 2) {
                return std::nullopt;
            }
            times = nb::borrow(tuple_item(given.ptr(), 0));
            given = nb::borrow(tuple_item(given.ptr(), 1));
        }
        const Samples& last = found.emplace_back(
            Samples{Given(numpy_, std::move(times)), Given(numpy_, std::move(given))});
        if (!last.times.count() || last.times.count() != last.values.count() ||
            *last.times.count() == 0) {
            return std::nullopt;
        }
    }
    return found;
}

// Whether the times are seconds near 0 whose ticks increase; as TimeScale._plain in
// rtamt.signals.ticks.
bool DenseDirectEvaluator::to_ticks(std::span<const double> seconds, std::int64_t* ticks) const {
    const double bound = std::min(near / rate_, implausible);
    // In order, all are as near as the first and the last; NaN is in no order.
    bool rising = -bound < seconds.front() && seconds.back() < bound;
    for (std::size_t i = 1; i < seconds.size(); ++i)
        rising &= seconds[i] > seconds[i - 1];
    if (!rising) return false;
    for (std::size_t i = 0; i < seconds.size(); ++i)
        ticks[i] = static_cast<std::int64_t>(std::nearbyint(seconds[i] * rate_));
    for (std::size_t i = 1; i < seconds.size(); ++i)
        rising &= ticks[i] > ticks[i - 1];
    return rising;
}

nb::object DenseDirectEvaluator::run(const nb::handle& data) {
    const auto given = samples_in(data);
    if (!given) return nb::none();
    std::size_t most = 0;
    std::size_t all = 0;
    for (const Samples& each : *given) {
        all += *each.times.count();
        most = std::max(most, *each.times.count());
    }
    const auto seconds = std::make_unique_for_overwrite<double[]>(most);
    const auto memory = new_bytes(16 * all);
    std::vector<Events> signals;
    signals.reserve(given->size());
    nb::list counts;
    std::size_t place = 0;
    std::int64_t start = -dense::never;
    std::int64_t end = -dense::never;
    for (const Samples& each : *given) {
        const std::size_t count = *each.times.count();
        auto* ticks = column<std::int64_t>(memory.ptr(), place);
        auto* values = column<double>(memory.ptr(), place + count);
        if (!each.times.copy_floats(seconds.get()) || !to_ticks({seconds.get(), count}, ticks) ||
            !each.values.copy(values)) {
            return nb::none();
        }
        signals.push_back({ticks, values, count});
        start = std::max(start, ticks[0]);
        end = std::max(end, ticks[count - 1]);
        counts.append(count);
        place += 2 * count;
    }
    if (start > end) return nb::none();
    auto found = evaluate(signals, all);
    if (!found || found->count() == 0) return nb::none();
    found->resize(found->view().until(end, found->count()));
    if (found->times()[found->count() - 1] < end) {
        found->append(end, found->values()[found->count() - 1]);
    }
    const std::size_t points = found->count();
    const NewArray times = numpy_.make(points);
    const NewArray values = numpy_.make(points);
    for (std::size_t i = 0; i < points; ++i)
        times.values()[i] = static_cast<double>(found->times()[i]) / rate_;
    std::copy_n(found->values(), points, values.values());
    return nb::make_tuple(memory, counts, signal_.made({times.array, values.array}));
}

// Nothing where a value is undefined.
std::optional<EventList> DenseDirectEvaluator::evaluate(std::vector<Events>& signals,
                                                        std::size_t samples) {
    std::vector<EventList> made; // by scans
    std::size_t scans = 0;
    for (const Stage& stage : stages_)
        scans += stage.scans.size();
    made.reserve(scans); // events point into them
    std::vector<Events> inputs;
    for (const Stage& stage : stages_) {
        const bool last = &stage == &stages_.back();
        inputs.clear();
        for (const std::size_t each : stage.signals)
            inputs.push_back(signals.at(each));
        std::vector<EventList> outputs(stage.program.outputs.size());
        const bool defined = without_gil(samples, [&] {
            std::unique_ptr<dense::Executor> executor(stage.spare->exchange(nullptr));
            if (!executor) executor = std::make_unique<dense::Executor>(stage.program);
            if (executor->evaluate(inputs, last ? 0 : extra_, outputs)) return false;
            if (samples <= most_kept) executor.reset(stage.spare->exchange(executor.release()));
            for (const Scan& each : stage.scans) {
                std::vector<Events> operands;
                operands.reserve(each.operands.size());
                for (const std::size_t operand : each.operands)
                    operands.push_back(outputs.at(operand).view());
                signals.push_back(made.emplace_back(dense_scan(each.kind, operands)).view());
            }
            return true;
        });
        if (!defined) return std::nullopt;
        if (last) return std::move(outputs.front());
    }
    return std::nullopt;
}

void add_dense_direct_evaluator(const nb::module_& m) {
    nb::class_<DenseDirectEvaluator>(m, "DenseDirectEvaluator",
                                     "Reads, checks and evaluates a recording in one call.")
        .def(nb::init<std::vector<nb::str>, nb::str, double, std::int64_t, const nb::list&,
                      const nb::object&>(),
             nb::arg("names"), nb::arg("time"), nb::arg("rate"), nb::arg("extra"),
             nb::arg("stages"), nb::arg("signal"))
        .def("run", &DenseDirectEvaluator::run, nb::arg("data").none(),
             "Evaluate a dict of signals; return ticks and values of each variable in a bytearray, "
             "the numbers of their samples, and the signal of the result. None if anything has to "
             "be "
             "converted, is wrong, or has no value.");
}

} // namespace rtamt::python
