// The classes Monitor and DenseMonitor of the extension module.
//
// Monitor.update, update_pairs and step, and DenseMonitor.update, are plain CPython functions of
// the METH_FASTCALL kind and not nanobind's: they read a dict or a list of pairs in place, where
// nanobind would first build a C++ container, and that would cost more than the sample does. The
// public monitors derive from the classes in online.cpp, which call them without a Python frame.
#include "monitor_module.hpp"

#include "calls.hpp"
#include "dense_monitor.hpp"
#include "locked_class.hpp"
#include "method_table.hpp"
#include "monitor.hpp"

#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace rtamt::python {

namespace {

PyObject* wrong_count(PyObject* self, const char* method, Py_ssize_t count) noexcept {
    const nb::object type =
        nb::steal(PyObject_GetAttrString(reinterpret_cast<PyObject*>(Py_TYPE(self)), "__name__"));
    if (!type.is_valid()) return nullptr;
    return PyErr_Format(PyExc_TypeError, "%U.%s takes 2 arguments, got %zd.", type.ptr(), method,
                        count);
}

template <class Monitor>
PyObject* update(PyObject* self, PyObject* const* args, Py_ssize_t count) noexcept {
    if (count != 2) return wrong_count(self, "update", count);
    const nb::ft_object2_guard guard(self, args[1]);
    auto* monitor = self_of<Monitor>(self);
    return monitor != nullptr ? monitor->update(args[0], InDict{args[1]}) : nullptr;
}

PyObject* update_pairs(PyObject* self, PyObject* const* args, Py_ssize_t count) noexcept {
    if (count != 2) return wrong_count(self, "update_pairs", count);
    const nb::ft_object2_guard guard(self, args[1]);
    auto* monitor = self_of<Monitor>(self);
    return monitor != nullptr ? monitor->update_pairs(args[0], args[1]) : nullptr;
}

PyObject* step(PyObject* self, PyObject* const* args, Py_ssize_t count) noexcept {
    const nb::ft_object_guard guard(self);
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
     "Take a dict of any inputs at a time in the unit of set_time_scale(); return what became "
     "known."},
    {nullptr, nullptr, 0, nullptr},
};

PyType_Slot dense_monitor_slots[] = {
    {Py_tp_methods, static_cast<void*>(dense_hot_methods)},
    {Py_tp_traverse, reinterpret_cast<void*>(traverse<DenseMonitor>)},
    {Py_tp_clear, reinterpret_cast<void*>(clear<DenseMonitor>)},
    {0, nullptr},
};

} // namespace

void add_monitors(const nanobind::module_& m, const Exceptions& exceptions) {
    LockedClass<Monitor>(m, "Monitor", nb::type_slots(monitor_slots),
                         "Runs a program online, one sample or one chunk at a time.")
        .def(
            "__init__",
            [exceptions](Monitor* self, const nb::bytes& program, const std::vector<nb::str>& names,
                         double period, double tolerance, bool strict, const nb::object& ignored,
                         const nb::list& calls, const nb::dict& types) {
                const auto held = std::make_shared<Calls>(calls);
                Program parsed = parse(program, Domain::discrete, held->sites());
                making(*held, [&] {
                    new (self) Monitor(std::move(parsed), names, period, tolerance, strict, ignored,
                                       types, held, exceptions);
                });
            },
            nb::arg("program"), nb::arg("names"), nb::arg("period") = 1.0,
            nb::arg("tolerance") = infinity, nb::arg("strict") = true,
            nb::arg("ignored") = nb::none(), nb::arg("calls") = nb::list(),
            nb::arg("types") = nb::dict())
        .def(
            "push",
            [](Monitor& self, const std::optional<Column>& times,
               const std::vector<Column>& columns,
               std::optional<std::int64_t> after) { return self.push(times, columns, after); },
            nb::arg("times").none(), nb::arg("columns"), nb::arg("after") = nb::none(),
            "Take a chunk, a column an input, unless others than `after` samples came before; "
            "return what became known of each output.")
        .def("accepts", &Monitor::accepts, nb::arg("times"), nb::arg("columns"),
             "Whether a chunk may be pushed as it is. False for data that has to be looked at, or "
             "is wrong.")
        .def("take_columns", &Monitor::take_columns, nb::arg("data").none(), nb::arg("time"),
             "Take a dict of columns; return the number of samples so far, and times and values of "
             "what became known of each output. None for data that has to be converted, or is "
             "wrong.")
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

    LockedClass<DenseMonitor>(m, "DenseMonitor", nb::type_slots(dense_monitor_slots),
                              "Runs a program online in dense time, one instant or one chunk at a "
                              "time; times are ticks.")
        .def(
            "__init__",
            [exceptions](DenseMonitor* self, const nb::bytes& program,
                         const std::vector<nb::str>& names, const nb::object& ignored,
                         const nb::list& calls, const nb::dict& types) {
                const auto held = std::make_shared<Calls>(calls);
                Program parsed = parse(program, Domain::dense, held->sites());
                making(*held, [&] {
                    new (self)
                        DenseMonitor(std::move(parsed), names, ignored, types, held, exceptions);
                });
            },
            nb::arg("program"), nb::arg("names"), nb::arg("ignored") = nb::none(),
            nb::arg("calls") = nb::list(), nb::arg("types") = nb::dict())
        .def("set_time_scale", &DenseMonitor::set_time_scale, nb::arg("signal"), nb::arg("scale"),
             nb::arg("rate"), nb::arg("whole") = false,
             "Set the unit of times of update(), in ticks, and whether they are integers alone; "
             "and the class of its results, with their scale.")
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
}

} // namespace rtamt::python
