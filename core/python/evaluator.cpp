#include "evaluator.hpp"

#include "../discrete/parts.hpp"
#include "arrays.hpp"

#include <algorithm>
#include <atomic>
#include <stdexcept>
#include <string>
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
             "is evaluated by at most threads() threads.");
}

} // namespace rtamt::python
