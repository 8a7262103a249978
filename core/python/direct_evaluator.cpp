#include "direct_evaluator.hpp"

#include "arrays.hpp"
#include "offline.hpp"

#include <nanobind/stl/array.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>

namespace rtamt::python {

namespace {

// Rows of doubles that Python gets.
class Rows {
  public:
    Rows(const NumPy& numpy, std::size_t rows, std::size_t count) : count_(count) {
        const std::size_t bytes = rows * count * sizeof(double);
        if (bytes < LargeMemory::least) {
            object_ =
                nb::steal(PyByteArray_FromStringAndSize(nullptr, static_cast<Py_ssize_t>(bytes)));
            if (!object_.is_valid()) throw nb::python_error();
            first_ = reinterpret_cast<double*>(PyByteArray_AsString(object_.ptr()));
            return;
        }
        nb::list arrays;
        for (std::size_t i = 0; i < rows; ++i) {
            const NewArray made = numpy.make(count);
            arrays.append(made.array);
            pointers_.push_back(made.values());
        }
        object_ = std::move(arrays);
    }

    [[nodiscard]] double* row(std::size_t i) const noexcept {
        return pointers_.empty() ? first_ + i * count_ : pointers_[i];
    }
    [[nodiscard]] const nb::object& object() const noexcept { return object_; }

  private:
    std::size_t count_;
    nb::object object_;
    double* first_ = nullptr;
    std::vector<double*> pointers_; // of arrays
};

} // namespace

DirectEvaluator::DirectEvaluator(std::vector<nb::str> names, nb::str time, const Admitted& admitted,
                                 const nb::list& stages, nb::object threads, SignalClasses classes)
    : names_(std::move(names)), time_(std::move(time)), admitted_(admitted),
      threads_(std::move(threads)), classes_(std::move(classes)) {
    using Scans = std::vector<nb::tuple>;
    for (const nb::handle each : stages) {
        const auto given = nb::cast<nb::tuple>(each);
        Stage stage{given[0],
                    nb::cast<Evaluator*>(given[0]),
                    nb::cast<std::vector<std::size_t>>(given[1]),
                    {}};
        for (const nb::tuple& scan : nb::cast<Scans>(given[2])) {
            stage.scans.push_back(
                {nb::cast<std::string>(scan[0]), nb::cast<std::vector<std::size_t>>(scan[1])});
        }
        stages_.push_back(std::move(stage));
    }
    if (stages_.empty() || stages_.back().evaluator->outputs() != 1) {
        throw std::invalid_argument("The last program of a plan has one output.");
    }
}

nb::object DirectEvaluator::run(const nb::handle& data) {
    const auto given = GivenColumns::of_dict_or_table(numpy_, data, names_, time_);
    if (!given || given->count < admitted_.fewest || given->count > admitted_.most) {
        return nb::none();
    }
    const std::size_t count = given->count;
    const std::size_t width = names_.size();
    if (!given->times && !admitted_.given && admitted_.period != 1.0) return nb::none();
    const std::size_t timed = given->times ? 1 : 0;
    const Rows rows(numpy_, width + timed, count);
    if (given->times && !read_times(*given->times, {rows.row(width), count})) return nb::none();
    std::vector<const double*> columns;
    columns.reserve(width);
    for (std::size_t i = 0; i < width; ++i) {
        if (!given->columns[i].copy(rows.row(i))) return nb::none();
        columns.push_back(rows.row(i));
    }
    const NewArray values = numpy_.make(count);
    if (!evaluate(columns, count, values.values())) return nb::none();
    const auto& kind = timed != 0 ? classes_.stored_times : classes_.regular_times;
    const nb::object times =
        kind.made({nb::int_(count), timed != 0 ? rows.object() : classes_.period, nb::none()});
    return nb::make_tuple(rows.object(), count, timed != 0,
                          classes_.signal.made({times, values.array}));
}

bool DirectEvaluator::read_times(const Given& given, std::span<double> seconds) const {
    return given.copy(seconds.data()) && ordered(seconds, {}) &&
           (admitted_.given || inferred_period(seconds) == admitted_.period) &&
           regular(seconds, {}, admitted_.period, admitted_.tolerance);
}

// Whether all values are defined.
bool DirectEvaluator::evaluate(std::vector<const double*>& columns, std::size_t count,
                               double* values) const {
    std::vector<std::unique_ptr<double[]>> made; // operands and results of scans
    const auto column = [&] {
        return made.emplace_back(std::make_unique_for_overwrite<double[]>(count)).get();
    };
    std::vector<const double*> inputs;
    std::vector<double*> outputs;
    for (const Stage& stage : stages_) {
        inputs.clear();
        for (const std::size_t place : stage.columns)
            inputs.push_back(columns.at(place));
        outputs.clear();
        if (&stage == &stages_.back()) {
            outputs.push_back(values);
        } else {
            for (std::size_t i = 0; i < stage.evaluator->outputs(); ++i)
                outputs.push_back(column());
        }
        const std::size_t threads = stage.evaluator->threads(count, threads_);
        const bool defined = without_gil(count, [&] {
            if (stage.evaluator->evaluate(inputs, count, outputs, threads)) return false;
            for (const Scan& each : stage.scans) {
                std::vector<std::span<const double>> operands;
                operands.reserve(each.operands.size());
                for (const std::size_t operand : each.operands)
                    operands.emplace_back(outputs.at(operand), count);
                double* result = column();
                scan(each.kind, operands, {result, count});
                columns.push_back(result);
            }
            return true;
        });
        if (!defined) return false;
    }
    return true;
}

void add_direct_evaluator(nb::module_& m) {
    m.def(
        "instance_maker",
        [](const nb::type_object& type, const std::array<std::string, 3>& slots) {
            const ResultClass<3> result(type,
                                        {slots[0].c_str(), slots[1].c_str(), slots[2].c_str()});
            return nb::cpp_function([result](nb::handle a, nb::handle b, nb::handle c) {
                return result.made({a, b, c});
            });
        },
        nb::arg("kind"), nb::arg("slots"),
        "Return a function that makes an instance of a class from the values of three slots, "
        "without __init__.");
    nb::class_<DirectEvaluator>(m, "DirectEvaluator",
                                "Reads, checks and evaluates a recording in one call.")
        .def(
            "__init__",
            [](DirectEvaluator* self, std::vector<nb::str> names, nb::str time, double period,
               bool given, double tolerance, std::size_t fewest, std::size_t most,
               const nb::list& stages, nb::object threads, const nb::object& signal,
               const nb::object& regular_times, const nb::object& stored_times,
               nb::object exact_period) {
                new (self) DirectEvaluator(
                    std::move(names), std::move(time), {period, given, tolerance, fewest, most},
                    stages, std::move(threads),
                    {ResultClass<2>(signal, {"_times", "_values"}),
                     ResultClass<3>(regular_times, {"_count", "_period", "_array"}),
                     ResultClass<3>(stored_times, {"_count", "_rows", "_array"}),
                     std::move(exact_period)});
            },
            nb::arg("names"), nb::arg("time"), nb::arg("period"), nb::arg("given"),
            nb::arg("tolerance"), nb::arg("fewest"), nb::arg("most"), nb::arg("stages"),
            nb::arg("threads"), nb::arg("signal"), nb::arg("regular_times"),
            nb::arg("stored_times"), nb::arg("exact_period"))
        .def("run", &DirectEvaluator::run, nb::arg("data").none(),
             "Evaluate a dict of columns, or a tuple of an array and a dict from names to its "
             "columns; return memory, count, whether there are timestamps, and the signal. None "
             "if anything has to be converted, is wrong, or has no value. The memory, a bytearray "
             "or a list of arrays, has the columns and the timestamps.");
}

} // namespace rtamt::python
