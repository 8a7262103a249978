#include "evaluator.hpp"

#include "../discrete/parts.hpp"
#include "arrays.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

namespace rtamt::python {

namespace {

// The memory of contiguous doubles that are to be as many as expected.
[[nodiscard]] Buffer column_of(PyObject* object, std::size_t count) {
    Buffer buffer(object, PyBUF_ND | PyBUF_FORMAT);
    if (!buffer) throw nb::python_error();
    const Py_buffer& view = buffer.view();
    if (buffer.format() != 'd' || view.ndim != 1) {
        throw std::invalid_argument("A column is not an array of doubles.");
    }
    if (std::cmp_not_equal(view.shape[0], count)) {
        throw std::invalid_argument("A column has " + std::to_string(view.shape[0]) +
                                    " samples where " + std::to_string(count) + " are expected.");
    }
    return buffer;
}

[[nodiscard]] std::vector<const double*> pointers_of(std::span<const Buffer> columns) {
    std::vector<const double*> pointers;
    pointers.reserve(columns.size());
    for (const Buffer& column : columns)
        pointers.push_back(static_cast<const double*>(column.view().buf));
    return pointers;
}

// New arrays of results.
struct Made {
    nb::list arrays;
    std::vector<double*> pointers;

    Made(const NumPy& numpy, std::size_t outputs, std::size_t count) {
        pointers.reserve(outputs);
        for (const NewArray& made : numpy.make(outputs, count)) {
            pointers.push_back(made.values());
            arrays.append(made.array);
        }
    }
};

// Puts rows into lanes, the last row into the lanes that are left, too.
template <class Value>
void gather(const double* rows, std::size_t lanes, std::size_t count, std::vector<Value>& values) {
    std::array<const double*, std::tuple_size_v<decltype(Value::lane)>> row{};
    for (std::size_t lane = 0; lane < row.size(); ++lane)
        row[lane] = rows + std::min(lane, lanes - 1) * count;
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t lane = 0; lane < row.size(); ++lane)
            values[i].lane[lane] = row[lane][i];
    }
}

template <class Value>
void scatter(const std::vector<Value>& values, std::size_t lanes, std::size_t count, double* rows) {
    for (std::size_t lane = 0; lane < lanes; ++lane) {
        for (std::size_t i = 0; i < count; ++i)
            rows[lane * count + i] = values[i].lane[lane];
    }
}

// The threads that an evaluation may have: those that are asked for, but for one for each other
// evaluation that runs.
class Share {
  public:
    explicit Share(std::size_t threads) noexcept
        : threads_(threads - std::min(threads - 1, running()++)) {}
    ~Share() { --running(); }
    Share(const Share&) = delete;
    Share& operator=(const Share&) = delete;
    Share(Share&&) = delete;
    Share& operator=(Share&&) = delete;

    [[nodiscard]] std::size_t threads() const noexcept { return threads_; }

  private:
    std::size_t threads_;

    [[nodiscard]] static std::atomic<std::size_t>& running() noexcept {
        static std::atomic<std::size_t> running{0};
        return running;
    }
};

} // namespace

Evaluator::Evaluator(const nb::bytes& program, Exceptions exceptions)
    : program_(parse(program)), exceptions_(std::move(exceptions)) {}

std::vector<Buffer> Evaluator::columns_of(const nb::list& columns, std::size_t count) const {
    if (columns.size() != program_.inputs) {
        throw std::invalid_argument("Got " + std::to_string(columns.size()) +
                                    " columns for a program with " +
                                    std::to_string(program_.inputs) + " inputs.");
    }
    std::vector<Buffer> held;
    held.reserve(columns.size());
    for (const nb::handle column : columns)
        held.push_back(column_of(column.ptr(), count));
    return held;
}

std::size_t Evaluator::threads(std::size_t count, const nb::object& allowed) const {
    // Some ten milliseconds: where others use the cores, too, a thread may have to wait for one.
    constexpr std::size_t worth_threads = std::size_t{1} << 24U;
    if (count < worth_threads / program_.instructions.size() || allowed.is_none()) return 1;
    return std::max<std::size_t>(nb::cast<std::size_t>(allowed()), 1);
}

nb::list Evaluator::run(const nb::list& columns, std::size_t count, const nb::object& allowed) {
    const auto held = columns_of(columns, count);
    const std::size_t threads = this->threads(count, allowed);
    const Made made(numpy_, program_.outputs.size(), count);
    const auto failure = without_gil(
        count, [&] { return evaluate(pointers_of(held), count, made.pointers, threads); });
    if (failure) {
        Calls none{nb::list()};
        raise_undefined(exceptions_, none, failure->instruction, failure->sample, failure->fault);
    }
    return made.arrays;
}

nb::tuple Evaluator::run_rows(const nb::list& columns, std::size_t rows, std::size_t count) {
    const auto held = columns_of(columns, rows * count);
    const Made made(numpy_, program_.outputs.size(), rows * count);
    const auto wrong = without_gil(
        rows * count, [&] { return evaluate_rows(pointers_of(held), rows, count, made.pointers); });
    return nb::make_tuple(made.arrays, wrong);
}

// Eight traces at a time; the last few as well, if they are not too few to pay off.
std::int64_t Evaluator::evaluate_rows(std::span<const double* const> columns, std::size_t rows,
                                      std::size_t count, std::span<double* const> outputs) {
    constexpr std::size_t worthwhile = 3;
    std::unique_ptr<LaneExecutor> executor(spare_lanes_.exchange(nullptr));
    std::vector<std::vector<Lane::Value>> inputs(columns.size());
    std::vector<std::vector<Lane::Value>> results(outputs.size());
    std::vector<const Lane::Value*> from;
    std::vector<Lane::Value*> to;
    for (auto& input : inputs) {
        input.resize(count);
        from.push_back(input.data());
    }
    for (auto& result : results) {
        result.resize(count);
        to.push_back(result.data());
    }
    std::vector<const double*> row_of(columns.size());
    std::vector<double*> result_of(outputs.size());
    const auto alone = [&](std::size_t row) {
        for (std::size_t i = 0; i < columns.size(); ++i)
            row_of[i] = columns[i] + row * count;
        for (std::size_t i = 0; i < outputs.size(); ++i)
            result_of[i] = outputs[i] + row * count;
        return !evaluate(row_of, count, result_of, 1);
    };
    for (std::size_t first = 0; first < rows; first += width) {
        const std::size_t lanes = std::min(width, rows - first);
        bool defined = lanes >= worthwhile;
        if (defined) {
            if (!executor) executor = std::make_unique<LaneExecutor>(program_);
            for (std::size_t i = 0; i < columns.size(); ++i)
                gather(columns[i] + first * count, lanes, count, inputs[i]);
            defined = !executor->evaluate(from, count, to);
            if (!defined) executor.reset();
        }
        if (defined) {
            for (std::size_t i = 0; i < outputs.size(); ++i)
                scatter(results[i], lanes, count, outputs[i] + first * count);
            continue;
        }
        for (std::size_t row = first; row < first + lanes; ++row) {
            if (!alone(row)) return static_cast<std::int64_t>(row);
        }
    }
    executor.reset(spare_lanes_.exchange(executor.release()));
    return -1;
}

std::optional<discrete::Failure> Evaluator::evaluate(std::span<const double* const> columns,
                                                     std::size_t count,
                                                     std::span<double* const> outputs,
                                                     std::size_t threads) {
    const Share share(threads);
    std::unique_ptr<Executor> executor(spare_.exchange(nullptr));
    const auto places = discrete::parts(program_, count);
    auto failure =
        discrete::evaluate_parts(program_, places, columns, outputs, share.threads(), executor);
    executor.reset(spare_.exchange(executor.release()));
    return failure;
}

void add_evaluator(const nb::module_& m, const Exceptions& exceptions) {
    nb::class_<Evaluator>(m, "Evaluator", "Runs a program without calls over whole traces.")
        .def(
            "__init__",
            [exceptions](Evaluator* self, const nb::bytes& program) {
                new (self) Evaluator(program, exceptions);
            },
            nb::arg("program"))
        .def("run", &Evaluator::run, nb::arg("columns"), nb::arg("n"),
             nb::arg("threads") = nb::none(),
             "Run over columns of n samples, one an input; return n values an output. A long trace "
             "is evaluated by at most threads() threads.")
        .def("run_rows", &Evaluator::run_rows, nb::arg("columns"), nb::arg("rows"), nb::arg("n"),
             "Run over many traces of n samples, one after another in each column; return as many "
             "values of each output, and the first trace with an undefined value, or -1.");
}

} // namespace rtamt::python
