#include "offline.hpp"

#include "../dense/executor.hpp"
#include "../dense/scan.hpp"
#include "../discrete/executor.hpp"
#include "../discrete/fewest_cells.hpp"
#include "../discrete/scan.hpp"
#include "../program/fusion.hpp"
#include "../program/liveness.hpp"
#include "../program/program.hpp"
#include "../values/interval.hpp"
#include "arrays.hpp"
#include "calls.hpp"
#include "dense_monitor.hpp"

#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rtamt::python {

using dense::EventList;
using discrete::Executor;

namespace {

std::vector<Result> evaluate(const nb::bytes& bytes, const std::vector<Column>& columns,
                             std::size_t count, const nb::list& calls,
                             const Exceptions& exceptions) {
    Calls held(calls);
    Program program = parse(bytes, Domain::discrete, held.sites());
    const auto pointers = pointers_of(columns, program.inputs, count);
    Results results;
    for (std::size_t i = 0; i < program.outputs.size(); ++i)
        results.add(count);
    const auto failure = making(held, [&] {
        return without_gil(count, [&] {
            return Executor::evaluate(std::move(program), pointers, count, results.pointers());
        });
    });
    if (failure) {
        raise_undefined(exceptions, held, failure->instruction, failure->sample, failure->fault);
    }
    return results.hand_over();
}

using Place = std::pair<std::optional<std::uint32_t>, std::optional<std::uint32_t>>;

std::vector<Place> layout(const Program& program) {
    const Fusion fusion = fused(program);
    const Registers found = registers(program, fusion);
    std::vector<Place> places(program.instructions.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
        if (fusion.chained[i]) places[i].first = fusion.roots[i];
        if (found.rows[i] != no_register) places[i].second = found.rows[i];
    }
    return places;
}

// The same of bounds: columns of (lower, upper), n of each.
nb::list evaluate_bounds(const nb::bytes& bytes, const std::vector<BoundsColumn>& columns,
                         std::size_t count, const Exceptions& exceptions) {
    const nb::list none;
    Calls held(none);
    Program program = parse(bytes, Domain::discrete);
    if (columns.size() != program.inputs) {
        throw std::invalid_argument("Got " + std::to_string(columns.size()) +
                                    " columns for a program with " +
                                    std::to_string(program.inputs) + " inputs.");
    }
    std::vector<std::vector<Bounds>> inputs;
    std::vector<const Bounds*> columns_of;
    for (const BoundsColumn& column : columns) {
        if (column.shape(0) != count) {
            throw std::invalid_argument("A column has " + std::to_string(column.shape(0)) +
                                        " samples where " + std::to_string(count) +
                                        " are expected.");
        }
        auto& input = inputs.emplace_back(count);
        for (std::size_t i = 0; i < count; ++i)
            input[i] = {column(i, 0), column(i, 1)};
        columns_of.push_back(input.data());
    }
    std::vector<std::vector<Bounds>> outputs(program.outputs.size());
    std::vector<Bounds*> results_of;
    for (auto& output : outputs) {
        output.resize(count);
        results_of.push_back(output.data());
    }
    const auto failure = without_gil(count, [&] {
        return discrete::BasicExecutor<Interval>::evaluate(std::move(program), columns_of, count,
                                                           results_of);
    });
    if (failure) {
        raise_undefined(exceptions, held, failure->instruction, failure->sample, failure->fault);
    }
    nb::list found;
    for (const auto& output : outputs) {
        Results bounds;
        bounds.add(count);
        bounds.add(count);
        const auto pointers = bounds.pointers();
        for (std::size_t i = 0; i < count; ++i) {
            pointers[0][i] = output[i].lower;
            pointers[1][i] = output[i].upper;
        }
        auto ends = bounds.hand_over();
        found.append(nb::make_tuple(std::move(ends[0]), std::move(ends[1])));
    }
    return found;
}

// Of traces of `count` samples each, one after another.
Result scan(std::string_view kind, const Column& a, const std::optional<Column>& b,
            std::optional<std::size_t> count) {
    const std::span<const double> first(a.data(), a.shape(0));
    std::optional<std::span<const double>> second;
    if (b) second.emplace(b->data(), b->shape(0));
    const std::size_t size = count.value_or(first.size());
    if (!first.empty() && (size == 0 || first.size() % size != 0)) {
        throw std::invalid_argument("The column does not consist of whole traces.");
    }
    if (second && second->size() != first.size()) {
        throw std::invalid_argument("The scan 'until' takes two columns of the same length.");
    }
    Results results;
    results.add(first.size());
    const std::span<double> out(results.pointers().front(), first.size());
    for (std::size_t begin = 0; begin == 0 || begin < first.size();
         begin += std::max<std::size_t>(size, 1)) {
        std::vector<std::span<const double>> operands{first.subspan(begin, size)};
        if (second) operands.push_back(second->subspan(begin, size));
        python::scan(kind, operands, out.subspan(begin, size));
    }
    return std::move(results.hand_over().front());
}

nb::list dense_evaluate(const nb::bytes& bytes, const std::vector<EventColumn>& columns,
                        std::int64_t extra, const nb::list& calls, const Exceptions& exceptions) {
    Calls held(calls);
    Program program = parse(bytes, Domain::dense, held.sites());
    const auto inputs = events_of(columns, program.inputs);
    if (extra < 0) throw std::invalid_argument("The extra ticks cannot be fewer than 0.");
    std::size_t count = 0;
    for (const auto& events : inputs)
        count += events.count;
    std::vector<EventList> outputs(program.outputs.size());
    const auto failure = making(held, [&] {
        return without_gil(count, [&] {
            return dense::Executor::evaluate(std::move(program), inputs, extra, outputs);
        });
    });
    if (failure) {
        raise_undefined(exceptions, held, failure->instruction, failure->time, failure->fault);
    }
    return hand_over(outputs);
}

// The same of bounds: of each input times and (lower, upper), of each output times, lower and
// upper.
nb::list dense_evaluate_bounds(const nb::bytes& bytes,
                               const std::vector<std::pair<Times, BoundsColumn>>& columns,
                               std::int64_t extra, const Exceptions& exceptions) {
    using Inputs = dense::BasicEvents<Bounds>;
    const nb::list none;
    Calls held(none);
    Program program = parse(bytes, Domain::dense);
    if (extra < 0) throw std::invalid_argument("The extra ticks cannot be fewer than 0.");
    if (columns.size() != program.inputs) {
        throw std::invalid_argument("Got " + std::to_string(columns.size()) +
                                    " signals for a program with " +
                                    std::to_string(program.inputs) + " inputs.");
    }
    std::vector<std::vector<Bounds>> values;
    std::vector<Inputs> inputs;
    std::size_t all = 0;
    for (const auto& [times, column] : columns) {
        const std::size_t count = times.shape(0);
        if (column.shape(0) != count) {
            throw std::invalid_argument("A signal has " + std::to_string(count) + " times and " +
                                        std::to_string(column.shape(0)) + " values.");
        }
        auto& ends = values.emplace_back(count);
        for (std::size_t i = 0; i < count; ++i)
            ends[i] = {column(i, 0), column(i, 1)};
        inputs.push_back({times.data(), ends.data(), count});
        all += count;
    }
    std::vector<dense::BasicEventList<Bounds>> outputs(program.outputs.size());
    const auto failure = without_gil(all, [&] {
        return dense::BasicExecutor<Interval>::evaluate(std::move(program), inputs, extra, outputs);
    });
    if (failure) {
        raise_undefined(exceptions, held, failure->instruction, failure->time, failure->fault);
    }
    nb::list found;
    for (const auto& output : outputs) {
        const auto events = output.view();
        EventList lower;
        Results upper;
        upper.add(events.count);
        for (std::size_t i = 0; i < events.count; ++i) {
            lower.append(events.times[i], events.values[i].lower);
            upper.pointers()[0][i] = events.values[i].upper;
        }
        const nb::tuple ends = hand_over(lower);
        found.append(nb::make_tuple(ends[0], ends[1], std::move(upper.hand_over()[0])));
    }
    return found;
}

nb::tuple dense_scan_of(std::string_view kind, const EventColumn& a,
                        const std::optional<EventColumn>& b) {
    std::vector<EventColumn> columns{a};
    if (b) columns.push_back(*b);
    EventList result = dense_scan(kind, events_of(columns, columns.size()));
    return hand_over(result);
}

} // namespace

void scan(std::string_view kind, std::span<const std::span<const double>> operands,
          std::span<double> out) {
    if (kind == "run_max") {
        discrete::scan<Max>(operands[0], out);
    } else if (kind == "run_min") {
        discrete::scan<Min>(operands[0], out);
    } else if (kind == "until") {
        if (operands.size() != 2) {
            throw std::invalid_argument("The scan 'until' takes two columns of the same length.");
        }
        discrete::scan_until<Real>(operands[0], operands[1], out);
    } else {
        throw std::invalid_argument("There is no scan '" + std::string(kind) +
                                    "': it is run_max, run_min or until.");
    }
}

EventList dense_scan(std::string_view kind, std::span<const dense::Events> operands) {
    if (kind == "run_max") return dense::scan<Max>(operands[0]);
    if (kind == "run_min") return dense::scan<Min>(operands[0]);
    if (kind != "until") {
        throw std::invalid_argument("There is no scan '" + std::string(kind) +
                                    "': it is run_max, run_min or until.");
    }
    if (operands.size() != 2) throw std::invalid_argument("The scan 'until' takes two signals.");
    return dense::scan_until<Real>(operands[0], operands[1]);
}

namespace {

// ---- explanations -------------------------------------------------------------------------------

using Ranges = nb::ndarray<const std::int64_t, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;
using Pairs = std::vector<std::pair<std::int64_t, std::int64_t>>;

[[nodiscard]] std::vector<discrete::CellRange> ranges_of(const Ranges& rows) {
    std::vector<discrete::CellRange> ranges;
    ranges.reserve(rows.shape(0));
    for (std::size_t i = 0; i < rows.shape(0); ++i)
        ranges.push_back({rows(i, 0), rows(i, 1)});
    return ranges;
}

[[nodiscard]] Pairs fewest_cells(const Ranges& asked, const Ranges& found, std::int64_t before,
                                 std::int64_t after, std::int64_t need) {
    const discrete::FewestCells fewest(ranges_of(asked), ranges_of(found), before, after, need);
    Pairs pairs;
    for (const discrete::CellRange& range : fewest.taken())
        pairs.emplace_back(range.begin, range.end);
    return pairs;
}

} // namespace

void add_offline(nanobind::module_& m, const Exceptions& exceptions) {
    m.def(
        "evaluate",
        [exceptions](const nb::bytes& program, const std::vector<Column>& columns, std::size_t n,
                     const nb::list& calls) {
            return evaluate(program, columns, n, calls, exceptions);
        },
        nb::arg("program"), nb::arg("columns"), nb::arg("n"), nb::arg("calls") = nb::list(),
        "Run a program over a whole trace of n samples; return n values an output.");
    m.def(
        "evaluate_bounds",
        [exceptions](const nb::bytes& program, const std::vector<BoundsColumn>& columns,
                     std::size_t n) { return evaluate_bounds(program, columns, n, exceptions); },
        nb::arg("program"), nb::arg("columns"), nb::arg("n"),
        "Run a program without calls over bounds of a whole trace, an array of shape (n, 2) an "
        "input; "
        "return lower and upper bounds of each output.");
    m.def(
        "scan",
        [](std::string_view kind, const Column& a, const std::optional<Column>& b,
           std::optional<std::size_t> n) { return scan(kind, a, b, n); },
        nb::arg("kind"), nb::arg("a"), nb::arg("b") = nb::none(), nb::arg("n") = nb::none(),
        "Unbounded future over a whole column, run_max, run_min, or until; with n, over traces of "
        "n samples each in it.");
    m.def("fewest_cells", &fewest_cells, nb::arg("asked"), nb::arg("found"), nb::arg("before"),
          nb::arg("after"), nb::arg("need"),
          "As few cells of `found` as possible, so that `need` of them are in each window [k + "
          "before, k + after] of the cells `asked`; ranges of cells are rows of begins and ends.");
    m.def(
        "memory",
        [](const nb::bytes& program, const nb::list& calls) {
            const Calls held(calls);
            return Executor::memory(parse(program, Domain::discrete, held.sites()));
        },
        nb::arg("program"), nb::arg("calls") = nb::list(),
        "Bytes of state of a new monitor of this program, but for the calls in it.");
    m.def(
        "layout",
        [](const nb::bytes& program, const nb::list& calls) {
            const Calls held(calls);
            return layout(parse(program, Domain::discrete, held.sites()));
        },
        nb::arg("program"), nb::arg("calls") = nb::list(),
        "What the passes make of a program in discrete time: for each instruction the root of the "
        "chain that it is computed in, and its register, None where there is none.");
    m.def(
        "dense_evaluate",
        [exceptions](const nb::bytes& program, const std::vector<EventColumn>& columns,
                     std::int64_t extra, const nb::list& calls) {
            return dense_evaluate(program, columns, extra, calls, exceptions);
        },
        nb::arg("program"), nb::arg("columns"), nb::arg("extra") = 0, nb::arg("calls") = nb::list(),
        "Run a program over whole signals, times and values of each, up to their last time and "
        "extra ticks more; return the events of each output.");
    m.def(
        "dense_evaluate_bounds",
        [exceptions](const nb::bytes& program,
                     const std::vector<std::pair<Times, BoundsColumn>>& columns,
                     std::int64_t extra) {
            return dense_evaluate_bounds(program, columns, extra, exceptions);
        },
        nb::arg("program"), nb::arg("columns"), nb::arg("extra") = 0,
        "Run a program without calls over bounds of whole signals, times and an array of shape "
        "(n, 2) of each; return times, lower and upper bounds of each output.");
    m.def("dense_scan", &dense_scan_of, nb::arg("kind"), nb::arg("a"), nb::arg("b") = nb::none(),
          "Unbounded future over whole step functions: run_max, run_min, or until.");
}

} // namespace rtamt::python
