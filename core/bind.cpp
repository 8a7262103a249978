// The extension module rtamt.engine._core: what Python may call, and nothing else.
//
// Monitor.update, update_pairs and step are plain CPython functions of the METH_FASTCALL kind and
// not nanobind's: they read a dict or a list of pairs in place, where nanobind would first build a
// C++ container, and that would cost more than the sample does.

#include "discrete/executor.hpp"
#include "discrete/scan.hpp"
#include "discrete/stamps.hpp"
#include "opcodes.hpp"
#include "program.hpp"
#include "python/arrays.hpp"
#include "python/monitor.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include <new>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace nb = nanobind;

namespace {

using rtamt::Program;
using rtamt::discrete::Executor;
using rtamt::python::Column;
using rtamt::python::Exceptions;
using rtamt::python::Monitor;
using rtamt::python::Result;
using rtamt::python::Results;

Program parse(const nb::bytes& bytes) {
    return Program::parse({static_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
}

// The method descriptor has checked that self is a Monitor, but not that __init__ has run.
Monitor*
self_of(PyObject* self) noexcept { // NOLINT(misc-const-correctness): CPython hands it over so
    if (nb::inst_ready(self)) [[likely]] {
        return nb::inst_ptr<Monitor>(self);
    }
    PyErr_SetString(PyExc_TypeError, "The monitor was never initialised.");
    return nullptr;
}

PyObject* wrong_count(const char* method, Py_ssize_t count) noexcept {
    return PyErr_Format(PyExc_TypeError, "Monitor.%s takes 2 arguments, got %zd.", method, count);
}

PyObject* update(PyObject* self, PyObject* const* args, Py_ssize_t count) noexcept {
    if (count != 2) return wrong_count("update", count);
    Monitor* monitor = self_of(self);
    return monitor != nullptr ? monitor->update(args[0], args[1]) : nullptr;
}

PyObject* update_pairs(PyObject* self, PyObject* const* args, Py_ssize_t count) noexcept {
    if (count != 2) return wrong_count("update_pairs", count);
    Monitor* monitor = self_of(self);
    return monitor != nullptr ? monitor->update_pairs(args[0], args[1]) : nullptr;
}

PyObject* step(PyObject* self, PyObject* const* args, Py_ssize_t count) noexcept {
    Monitor* monitor = self_of(self);
    return monitor != nullptr ? monitor->step({args, static_cast<std::size_t>(count)}) : nullptr;
}

// CPython stores every kind of method as a PyCFunction and calls it by its METH_ flags.
template <class Function>
PyCFunction erased(Function* function) noexcept {
    return reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(function));
}

PyMethodDef hot_methods[] = {
    {"update", erased(update), METH_FASTCALL,
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

PyType_Slot monitor_slots[] = {
    {Py_tp_methods, static_cast<void*>(hot_methods)},
    {0, nullptr},
};

std::vector<Result> evaluate(const nb::bytes& bytes, const std::vector<Column>& columns,
                             std::size_t count, const Exceptions& exceptions) {
    Program program = parse(bytes);
    const auto pointers = rtamt::python::pointers_of(columns, program.inputs, count);
    Results results;
    for (std::size_t i = 0; i < program.outputs.size(); ++i)
        results.add(count);
    const auto failure = rtamt::python::without_gil(count, [&] {
        return Executor::evaluate(std::move(program), pointers, count, results.pointers());
    });
    if (failure) rtamt::python::raise_undefined(exceptions, *failure);
    return results.hand_over();
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
        rtamt::discrete::scan_until(first, {b->data(), b->shape(0)}, out);
    } else {
        throw std::invalid_argument("There is no scan '" + std::string(kind) +
                                    "': it is run_max, run_min or until.");
    }
    return std::move(results.hand_over().front());
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
    m.doc() = "The compiled back end: runs serialised programs over samples in discrete time.";

    const Exceptions exceptions{
        new_exception(m, "Refused", "An update was refused; the monitor is as it was."),
        new_exception(m, "Undefined",
                      "An operation made NaN; args are the instruction and the sample.")};

    nb::class_<Monitor>(m, "Monitor", nb::type_slots(monitor_slots),
                        "Runs a program online, one sample or one chunk at a time.")
        .def(
            "__init__",
            [exceptions](Monitor* self, const nb::bytes& program, const std::vector<nb::str>& names,
                         double period, double tolerance, bool strict, const nb::object& ignored) {
                new (self)
                    Monitor(parse(program), names, period, tolerance, strict, ignored, exceptions);
            },
            nb::arg("program"), nb::arg("names"), nb::arg("period") = 1.0,
            nb::arg("tolerance") = rtamt::infinity, nb::arg("strict") = true,
            nb::arg("ignored") = nb::none())
        .def("push", &Monitor::push, nb::arg("times").none(), nb::arg("columns"),
             "Take a chunk, a column an input; return what became known of each output.")
        .def("finish", &Monitor::finish, "End the trace; return the rest of each output.")
        .def("reset", &Monitor::reset, "Forget every sample.")
        .def("last", &Monitor::last, nb::arg("instruction"),
             "The value of an instruction at the last slot.")
        .def("recent", &Monitor::recent, nb::arg("count"),
             "The times of the last samples, as many as values can be outstanding and one more.")
        .def_prop_ro("samples", &Monitor::samples, "How many samples came.")
        .def_prop_ro("violations", &Monitor::violations, "How many gaps were out of tolerance.")
        .def_prop_ro("last_time", &Monitor::last_time, "The time of the last sample, or NaN.")
        .def_prop_ro("state_bytes", &Monitor::state_bytes, "Bytes of state.");

    m.def("opcode_names", &opcode_names, "The names of the opcodes, in the order of their codes.");
    m.def(
        "evaluate",
        [exceptions](const nb::bytes& program, const std::vector<Column>& columns, std::size_t n) {
            return evaluate(program, columns, n, exceptions);
        },
        nb::arg("program"), nb::arg("columns"), nb::arg("n"),
        "Run a program over a whole trace of n samples; return n values an output.");
    m.def("scan", &scan, nb::arg("kind"), nb::arg("a"), nb::arg("b") = nb::none(),
          "Unbounded future over a whole column: run_max, run_min, or until.");
    m.def(
        "memory", [](const nb::bytes& program) { return Executor::memory(parse(program)); },
        nb::arg("program"), "Bytes of state of a new monitor of this program.");
}
