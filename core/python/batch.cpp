#include "batch.hpp"

#include "../discrete/batch.hpp"
#include "arrays.hpp"
#include "evaluator.hpp"
#include "numpy.hpp"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace rtamt::python {

namespace {

using Given = nb::ndarray<const double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using Written = nb::ndarray<double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using RowNumbers = nb::ndarray<const std::int64_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

[[nodiscard]] Scan scan_of(const nb::tuple& given) {
    const auto kind = nb::cast<std::string>(given[0]);
    const auto operands = nb::cast<std::vector<std::size_t>>(given[1]);
    Scan scan{ScanKind::until, operands.at(0), operands.back()};
    if (kind == "run_max") {
        scan.kind = ScanKind::run_max;
    } else if (kind == "run_min") {
        scan.kind = ScanKind::run_min;
    } else if (kind != "until" || operands.size() != 2) {
        throw std::invalid_argument("There is no scan '" + kind + "' of " +
                                    std::to_string(operands.size()) + " columns in a batch.");
    }
    return scan;
}

// The stages as for DirectEvaluator (direct_evaluator.hpp).
[[nodiscard]] std::vector<Stage> stages_of(const nb::list& given) {
    std::vector<Stage> stages;
    for (const nb::handle each : given) {
        const auto parts = nb::cast<nb::tuple>(each);
        Stage stage{nb::cast<const Evaluator*>(parts[0])->program(),
                    nb::cast<std::vector<std::size_t>>(parts[1]),
                    {}};
        for (const nb::tuple& scan : nb::cast<std::vector<nb::tuple>>(parts[2]))
            stage.scans.push_back(scan_of(scan));
        stages.push_back(std::move(stage));
    }
    return stages;
}

[[nodiscard]] bool run(discrete::Batch& batch, const std::vector<Given>& columns,
                       const RowNumbers& rows, std::size_t count, const Written& results) {
    const std::size_t width = results.shape(1);
    std::vector<const double*> pointers;
    for (const Given& column : columns) {
        if (column.shape(0) != results.shape(0) || column.shape(1) != width) {
            throw std::invalid_argument("The columns and the results differ in their shapes.");
        }
        pointers.push_back(column.data());
    }
    const std::span<const std::int64_t> numbers(rows.data(), rows.shape(0));
    const bool there = std::ranges::all_of(numbers, [&](std::int64_t row) {
        return row >= 0 && std::cmp_less(row, results.shape(0));
    });
    if (pointers.size() != batch.variables() || count == 0 || count > width || !there) {
        throw std::invalid_argument("A batch is asked for other rows or columns than it has.");
    }
    const discrete::BatchRows asked{pointers, numbers, width, count, results.data()};
    return without_gil(numbers.size() * count, [&] { return batch.evaluate(asked); });
}

} // namespace

void add_batch(nb::module_& m) {
    using discrete::Batch;
    nb::class_<Batch>(m, "Batch", "Evaluates a plan on many traces of one length at a time.")
        .def(
            "__init__",
            [](Batch* self, const nb::list& stages, std::size_t variables) {
                new (self) Batch(stages_of(stages), variables);
            },
            nb::arg("stages"), nb::arg("variables"))
        .def("run", &run, nb::arg("columns"), nb::arg("rows"), nb::arg("n"), nb::arg("results"),
             "Evaluate the first n samples of these rows of the columns, and write the values to "
             "the same rows of the results. False where a value is undefined.")
        .def_prop_ro("joins_words", &Batch::joins_words,
                     "Whether truth values of 64 traces are joined at once.");
    m.def(
        "new_rows",
        [numpy = NumPy()](std::size_t rows, std::size_t width) {
            return numpy.make(rows * width).array.attr("reshape")(rows, width);
        },
        nb::arg("rows"), nb::arg("width"),
        "A new array of this shape, of any numbers, in memory that is used again (LargeMemory).");
}

} // namespace rtamt::python
