// The extension module rtamt.engine._core: what Python may call, and nothing else.
//
// Monitor.update, update_pairs and step, and DenseMonitor.update, are plain CPython functions of
// the METH_FASTCALL kind and not nanobind's: they read a dict or a list of pairs in place, where
// nanobind would first build a C++ container, and that would cost more than the sample does. The
// public monitors derive from the classes in online.cpp, which call them without a Python frame.

#include "../dense/executor.hpp"
#include "../dense/scan.hpp"
#include "../discrete/executor.hpp"
#include "../discrete/scan.hpp"
#include "../discrete/stamps.hpp"
#include "../program/opcodes.hpp"
#include "../program/program.hpp"
#include "../values/interval.hpp"
#include "arrays.hpp"
#include "calls.hpp"
#include "dense_monitor.hpp"
#include "early_monitor.hpp"
#include "failures.hpp"
#include "method_table.hpp"
#include "monitor.hpp"
#include "online.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace nb = nanobind;

namespace {

using rtamt::CallSite;
using rtamt::Domain;
using rtamt::Program;
using rtamt::dense::EventList;
using rtamt::discrete::Executor;
using rtamt::python::BoundsColumn;
using rtamt::python::Calls;
using rtamt::python::Column;
using rtamt::python::DenseMonitor;
using rtamt::python::erased;
using rtamt::python::EventColumn;
using rtamt::python::Exceptions;
using rtamt::python::InDict;
using rtamt::python::Monitor;
using rtamt::python::Result;
using rtamt::python::Results;
using rtamt::python::self_of;

Program parse(const nb::bytes& bytes, Domain domain = Domain::discrete,
              std::vector<CallSite> calls = {}) {
    return Program::parse({static_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, domain,
                          std::move(calls));
}

// Calls `work`; what a Python operator raised when it was made goes before what the core threw.
template <class Work>
auto making(Calls& calls, Work&& work) {
    try {
        return std::forward<Work>(work)();
    } catch (const std::runtime_error&) {
        calls.rethrow();
        throw;
    }
}

PyObject* wrong_count(PyObject* self, const char* method, Py_ssize_t count) noexcept {
    const std::string_view type = Py_TYPE(self)->tp_name;
    return PyErr_Format(PyExc_TypeError, "%s.%s takes 2 arguments, got %zd.",
                        type.data() + type.rfind('.') + 1, method, count);
}

template <class Monitor>
PyObject* update(PyObject* self, PyObject* const* args, Py_ssize_t count) noexcept {
    if (count != 2) return wrong_count(self, "update", count);
    auto* monitor = self_of<Monitor>(self);
    return monitor != nullptr ? monitor->update(args[0], InDict{args[1]}) : nullptr;
}

PyObject* update_pairs(PyObject* self, PyObject* const* args, Py_ssize_t count) noexcept {
    if (count != 2) return wrong_count(self, "update_pairs", count);
    auto* monitor = self_of<Monitor>(self);
    return monitor != nullptr ? monitor->update_pairs(args[0], args[1]) : nullptr;
}

PyObject* step(PyObject* self, PyObject* const* args, Py_ssize_t count) noexcept {
    auto* monitor = self_of<Monitor>(self);
    return monitor != nullptr ? monitor->step({args, static_cast<std::size_t>(count)}) : nullptr;
}

PyMethodDef hot_methods[] = {
    {"update", erased(update<Monitor>), METH_FASTCALL,
     "update($self, t, values, /)\n--\n\n"
     "Take the sample of time t, a dict of every input; return what became known, or None."},
    {"update_pairs", erased(update_pairs), METH_FASTCALL,
     "update_pairs($self, t, pairs, /)\n--\n\n"
     "The same from (name, value) pairs; a variable left out keeps its value."},
    {"step", erased(step), METH_FASTCALL,
     "step($self, *values)\n--\n\n"
     "Take the next sample, one value an input, a period after the last one."},
    {nullptr, nullptr, 0, nullptr},
};

template <class Monitor>
int traverse(PyObject* self, visitproc visit, void* arg) {
    Py_VISIT(Py_TYPE(self));
    return nb::inst_ready(self) ? nb::inst_ptr<Monitor>(self)->calls().traverse(visit, arg) : 0;
}

template <class Monitor>
int clear(PyObject* self) {
    if (nb::inst_ready(self)) nb::inst_ptr<Monitor>(self)->calls().clear();
    return 0;
}

PyType_Slot monitor_slots[] = {
    {Py_tp_methods, static_cast<void*>(hot_methods)},
    {Py_tp_traverse, reinterpret_cast<void*>(traverse<Monitor>)},
    {Py_tp_clear, reinterpret_cast<void*>(clear<Monitor>)},
    {0, nullptr},
};

PyMethodDef dense_hot_methods[] = {
    {"update", erased(update<DenseMonitor>), METH_FASTCALL,
     "update($self, t, values, /)\n--\n\n"
     "Take a dict of any inputs at a time as set_time_scale() says; return what became known."},
    {nullptr, nullptr, 0, nullptr},
};

PyType_Slot dense_monitor_slots[] = {
    {Py_tp_methods, static_cast<void*>(dense_hot_methods)},
    {Py_tp_traverse, reinterpret_cast<void*>(traverse<DenseMonitor>)},
    {Py_tp_clear, reinterpret_cast<void*>(clear<DenseMonitor>)},
    {0, nullptr},
};

std::vector<Result> evaluate(const nb::bytes& bytes, const std::vector<Column>& columns,
                             std::size_t count, const nb::list& calls,
                             const Exceptions& exceptions) {
    Calls held(calls);
    Program program = parse(bytes, Domain::discrete, held.sites());
    const auto pointers = rtamt::python::pointers_of(columns, program.inputs, count);
    Results results;
    for (std::size_t i = 0; i < program.outputs.size(); ++i)
        results.add(count);
    const auto failure = making(held, [&] {
        return rtamt::python::without_gil(count, [&] {
            return Executor::evaluate(std::move(program), pointers, count, results.pointers());
        });
    });
    if (failure) {
        rtamt::python::raise_undefined(exceptions, held, failure->instruction, failure->sample,
                                       failure->fault);
    }
    return results.hand_over();
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
    std::vector<std::vector<rtamt::Bounds>> inputs;
    std::vector<const rtamt::Bounds*> columns_of;
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
    std::vector<std::vector<rtamt::Bounds>> outputs(program.outputs.size());
    std::vector<rtamt::Bounds*> results_of;
    for (auto& output : outputs) {
        output.resize(count);
        results_of.push_back(output.data());
    }
    const auto failure = rtamt::python::without_gil(count, [&] {
        return rtamt::discrete::BasicExecutor<rtamt::Interval>::evaluate(
            std::move(program), columns_of, count, results_of);
    });
    if (failure) {
        rtamt::python::raise_undefined(exceptions, held, failure->instruction, failure->sample,
                                       failure->fault);
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

Result scan(std::string_view kind, const Column& a, const std::optional<Column>& b) {
    const std::span<const double> first(a.data(), a.shape(0));
    Results results;
    results.add(first.size());
    const std::span<double> out(results.pointers().front(), first.size());
    if (kind == "run_max") {
        rtamt::discrete::scan<rtamt::Max>(first, out);
    } else if (kind == "run_min") {
        rtamt::discrete::scan<rtamt::Min>(first, out);
    } else if (kind == "until") {
        if (!b || b->shape(0) != first.size()) {
            throw std::invalid_argument("The scan 'until' takes two columns of the same length.");
        }
        rtamt::discrete::scan_until<rtamt::Real>(first, {b->data(), b->shape(0)}, out);
    } else {
        throw std::invalid_argument("There is no scan '" + std::string(kind) +
                                    "': it is run_max, run_min or until.");
    }
    return std::move(results.hand_over().front());
}

nb::list dense_evaluate(const nb::bytes& bytes, const std::vector<EventColumn>& columns,
                        std::int64_t extra, const nb::list& calls, const Exceptions& exceptions) {
    Calls held(calls);
    Program program = parse(bytes, Domain::dense, held.sites());
    const auto inputs = rtamt::python::events_of(columns, program.inputs);
    if (extra < 0) throw std::invalid_argument("The extra ticks cannot be fewer than 0.");
    std::size_t count = 0;
    for (const auto& events : inputs)
        count += events.count;
    std::vector<EventList> outputs(program.outputs.size());
    const auto failure = making(held, [&] {
        return rtamt::python::without_gil(count, [&] {
            return rtamt::dense::Executor::evaluate(std::move(program), inputs, extra, outputs);
        });
    });
    if (failure) {
        rtamt::python::raise_undefined(exceptions, held, failure->instruction, failure->time,
                                       failure->fault);
    }
    return rtamt::python::hand_over(outputs);
}

nb::tuple dense_scan(std::string_view kind, const EventColumn& a,
                     const std::optional<EventColumn>& b) {
    std::vector<EventColumn> columns{a};
    if (b) columns.push_back(*b);
    const auto events = rtamt::python::events_of(columns, columns.size());
    if (kind == "until" && !b) {
        throw std::invalid_argument("The scan 'until' takes two signals.");
    }
    EventList result;
    if (kind == "run_max") {
        result = rtamt::dense::scan<rtamt::Max>(events[0]);
    } else if (kind == "run_min") {
        result = rtamt::dense::scan<rtamt::Min>(events[0]);
    } else if (kind == "until") {
        result = rtamt::dense::scan_until<rtamt::Real>(events[0], events[1]);
    } else {
        throw std::invalid_argument("There is no scan '" + std::string(kind) +
                                    "': it is run_max, run_min or until.");
    }
    return rtamt::python::hand_over(result);
}

std::vector<std::string_view> opcode_names() {
    std::vector<std::string_view> names;
    names.reserve(rtamt::opcodes.size());
    for (const rtamt::OpcodeInfo& opcode : rtamt::opcodes)
        names.push_back(opcode.name);
    return names;
}

nb::object new_exception(const nb::module_& module, const char* name, const char* doc) {
    const auto qualified = nb::cast<std::string>(module.attr("__name__")) + "." + name;
    auto type = nb::steal<nb::object>(
        PyErr_NewExceptionWithDoc(qualified.c_str(), doc, PyExc_Exception, nullptr));
    if (!type.is_valid()) throw nb::python_error();
    nb::setattr(module, name, type);
    return type;
}

} // namespace

NB_MODULE(_core, m) {
    m.doc() =
        "The compiled back end: runs serialised programs over samples, in discrete or dense time.";

    nb::register_exception_translator(rtamt::python::translate_memory);

    const Exceptions exceptions{
        new_exception(m, "Refused", "An update was refused; the monitor is as it was."),
        nb::module_::import_("rtamt.engine.gate").attr("in_use"),
        new_exception(m, "Undefined",
                      "An operation made NaN; args are the instruction and the sample, or "
                      "the tick in dense time; online in discrete time `time` is that of the "
                      "sample. Or a call failed: then also what it said, and "
                      "the cause is what a Python operator raised.")};

    nb::class_<Monitor>(m, "Monitor", nb::type_slots(monitor_slots),
                        "Runs a program online, one sample or one chunk at a time.")
        .def(
            "__init__",
            [exceptions](Monitor* self, const nb::bytes& program, const std::vector<nb::str>& names,
                         double period, double tolerance, bool strict, const nb::object& ignored,
                         const nb::list& calls) {
                const auto held = std::make_shared<Calls>(calls);
                Program parsed = parse(program, Domain::discrete, held->sites());
                making(*held, [&] {
                    new (self) Monitor(std::move(parsed), names, period, tolerance, strict, ignored,
                                       held, exceptions);
                });
            },
            nb::arg("program"), nb::arg("names"), nb::arg("period") = 1.0,
            nb::arg("tolerance") = rtamt::infinity, nb::arg("strict") = true,
            nb::arg("ignored") = nb::none(), nb::arg("calls") = nb::list())
        .def("push", &Monitor::push, nb::arg("times").none(), nb::arg("columns"),
             nb::arg("after") = nb::none(),
             "Take a chunk, a column an input, unless others than `after` samples came before; "
             "return what became known of each output.")
        .def("finish", &Monitor::finish, "End the trace; return the rest of each output.")
        .def("reset", &Monitor::reset, "Forget every sample.")
        .def("state", &Monitor::state, "What the samples so far have left behind.")
        .def("restore", &Monitor::restore, nb::arg("state"),
             "Go on as the monitor of this state would, which was made like this one.")
        .def("last", &Monitor::last, nb::arg("instruction"),
             "The value of an instruction at the last slot, or None before the first.")
        .def("latest", &Monitor::latest, nb::arg("output"),
             "The value of an output that the last sample made known, or None.")
        .def("recent", &Monitor::recent, nb::arg("count"),
             "The times of the last samples, as many as values can be outstanding and one more.")
        .def_prop_ro("samples", &Monitor::samples, "How many samples came.")
        .def_prop_ro("violations", &Monitor::violations, "How many gaps were out of tolerance.")
        .def_prop_ro("last_time", &Monitor::last_time, "The time of the last sample, or None.")
        .def_prop_ro("state_bytes", &Monitor::state_bytes, "Bytes of state.");

    nb::class_<DenseMonitor>(m, "DenseMonitor", nb::type_slots(dense_monitor_slots),
                             "Runs a program online in dense time, one instant or one chunk at a "
                             "time; times are ticks.")
        .def(
            "__init__",
            [exceptions](DenseMonitor* self, const nb::bytes& program,
                         const std::vector<nb::str>& names, const nb::object& ignored,
                         const nb::list& calls) {
                const auto held = std::make_shared<Calls>(calls);
                Program parsed = parse(program, Domain::dense, held->sites());
                making(*held, [&] {
                    new (self) DenseMonitor(std::move(parsed), names, ignored, held, exceptions);
                });
            },
            nb::arg("program"), nb::arg("names"), nb::arg("ignored") = nb::none(),
            nb::arg("calls") = nb::list())
        .def("set_time_scale", &DenseMonitor::set_time_scale, nb::arg("signal"), nb::arg("scale"),
             nb::arg("rate"), nb::arg("whole") = false,
             "Say how update() tells time: in numbers of so many ticks, or in integers alone; and "
             "of which class its answers are, with which scale.")
        .def("push", &DenseMonitor::push, nb::arg("columns"),
             "Take a chunk, times and values of each input; return what became known of the first "
             "output, times and values.")
        .def("finish", &DenseMonitor::finish, "End the trace; return the rest of the first output.")
        .def("last_output", &DenseMonitor::last_output, nb::arg("output"),
             "What the last update made known of an output, times and values.")
        .def("points", &DenseMonitor::points,
             "The same of every output: a list for each, of pairs of time and value.")
        .def("reset", &DenseMonitor::reset, "Forget every sample.")
        .def("state", &DenseMonitor::state,
             "What the samples so far have left behind, except the time scale.")
        .def("restore", &DenseMonitor::restore, nb::arg("state"),
             "Go on as the monitor of this state would, which was made like this one.")
        .def("known", &DenseMonitor::known, nb::arg("output"),
             "The last tick at which an output is known, or None.")
        .def_prop_ro(
            "known_until", [](const DenseMonitor& self) { return self.known(0); },
            "The last tick at which the first output is known, or None.")
        .def_prop_ro("counts", &DenseMonitor::counts, "How many samples of each input came.")
        .def_prop_ro("start", &DenseMonitor::start, "The tick at which the trace begins, or None.")
        .def_prop_ro("last_times", &DenseMonitor::last_times,
                     "The tick of the last sample of each input, or None.")
        .def_prop_ro("last_possible", &DenseMonitor::last_possible,
                     "The latest tick that a sample may have.")
        .def_prop_ro("state_bytes", &DenseMonitor::state_bytes, "Bytes of state by now.");

    rtamt::python::add_early_monitor(m, exceptions);
    rtamt::python::add_online(m);

    m.def("opcode_names", &opcode_names, "The names of the opcodes, in the order of their codes.");
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
    m.def("scan", &scan, nb::arg("kind"), nb::arg("a"), nb::arg("b") = nb::none(),
          "Unbounded future over a whole column: run_max, run_min, or until.");
    m.def(
        "memory",
        [](const nb::bytes& program, const nb::list& calls) {
            const Calls held(calls);
            return Executor::memory(parse(program, Domain::discrete, held.sites()));
        },
        nb::arg("program"), nb::arg("calls") = nb::list(),
        "Bytes of state of a new monitor of this program, but for the calls in it.");
    m.def(
        "dense_evaluate",
        [exceptions](const nb::bytes& program, const std::vector<EventColumn>& columns,
                     std::int64_t extra, const nb::list& calls) {
            return dense_evaluate(program, columns, extra, calls, exceptions);
        },
        nb::arg("program"), nb::arg("columns"), nb::arg("extra") = 0, nb::arg("calls") = nb::list(),
        "Run a program over whole signals, times and values of each, up to their last time and "
        "extra ticks more; return the events of each output.");
    m.def("dense_scan", &dense_scan, nb::arg("kind"), nb::arg("a"), nb::arg("b") = nb::none(),
          "Unbounded future over whole step functions: run_max, run_min, or until.");
}
