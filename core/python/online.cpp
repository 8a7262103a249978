#include "online.hpp"

#include "dense_monitor.hpp"
#include "early_backend.hpp"
#include "locked_class.hpp"
#include "method_table.hpp"
#include "monitor.hpp"

#include <utility>
#include <vector>

namespace rtamt::python {

namespace {

// Of the module, which outlives every call.
struct Known {
    nb::handle refused;
    nb::handle undefined;
};
Known& known() noexcept {
    static Known known;
    return known;
}

// Calls a Python method of the monitor with unchanged arguments.
PyObject* carefully(PyObject* self, const char* method, std::span<PyObject* const> positional,
                    const Named& named) noexcept {
    try {
        std::vector<PyObject*> all{self};
        all.insert(all.end(), positional.begin(), positional.end());
        all.insert(all.end(), named.values, named.values + named.count());
        const nb::object name = nb::steal(PyUnicode_InternFromString(method));
        if (!name.is_valid()) return nullptr;
        return PyObject_VectorcallMethod(name.ptr(), all.data(), positional.size() + 1,
                                         named.names);
    } catch (const std::bad_alloc&) {
        return PyErr_NoMemory();
    }
}

// Replaces Undefined by the error that Python makes of it.
void explain(PyObject* self) noexcept {
    PyObject* type = nullptr;
    PyObject* value = nullptr;
    PyObject* trace = nullptr;
    PyErr_Fetch(&type, &value, &trace);
    PyErr_NormalizeException(&type, &value, &trace);
    const auto error = nb::steal(PyObject_CallMethod(self, "_no_value", "O", value));
    if (error.is_valid()) PyErr_SetObject(error.type().ptr(), error.ptr());
    Py_XDECREF(type);
    Py_XDECREF(value);
    Py_XDECREF(trace);
}

// Whether Python takes over the arguments after a failure; if not, the exception stays.
bool goes_on(PyObject* self) noexcept {
    if (PyErr_ExceptionMatches(known().undefined.ptr()) != 0) {
        explain(self);
        return false;
    }
    if (PyErr_ExceptionMatches(known().refused.ptr()) == 0) return false;
    PyErr_Clear();
    return true;
}

// Has the compiled monitor take the sample, else Python.
template <class Backend, class Take>
PyObject* sample(PyObject* self, const char* method, std::span<PyObject* const> positional,
                 const Named& named, Take&& take) noexcept {
    const auto* online = self_of<Online<Backend>>(self);
    if (online == nullptr) return nullptr;
    const auto [native, held] = online->connected(self);
    if (native != nullptr) [[likely]] {
        const auto [taken, result] = take(*native, held);
        if (taken && (result != nullptr || !goes_on(self))) return result;
    }
    return carefully(self, method, positional, named);
}

struct Taken {
    bool taken = false; // whether the arguments are of the ordinary form
    PyObject* result = nullptr;
};

template <class Backend>
PyObject* update(PyObject* self, PyObject* const* args, Py_ssize_t count,
                 PyObject* names) noexcept {
    const std::span positional(args, static_cast<std::size_t>(count));
    const Named named{names, args + count};
    return sample<Backend>(self, "_update_carefully", positional, named,
                           [&](Backend& native, nb::handle lock) {
                               if (count != 1) return Taken{false};
                               const nb::ft_object_guard guard(lock);
                               return Taken{true, native.update(args[0], named)};
                           });
}

PyObject* step(PyObject* self, PyObject* const* args, Py_ssize_t count, PyObject* names) noexcept {
    const std::span positional(args, static_cast<std::size_t>(count));
    const Named named{names, args + count};
    return sample<Monitor>(self, "_step_carefully", positional, named,
                           [&](Monitor& native, nb::handle lock) {
                               if (names != nullptr) return Taken{false};
                               const nb::ft_object_guard guard(lock);
                               return Taken{true, native.step(positional)};
                           });
}

PyMethodDef methods[] = {
    {"update", erased(update<Monitor>), METH_FASTCALL | METH_KEYWORDS,
     "update($self, time, /, **values)\n--\n\n"
     "Take one sample: its time and a number for every variable; return what became known."},
    {"step", erased(step), METH_FASTCALL | METH_KEYWORDS,
     "step($self, /, *values)\n--\n\n"
     "Take one sample by position, one period after the last; return what became known."},
    {nullptr, nullptr, 0, nullptr},
};

PyMethodDef dense_methods[] = {
    {"update", erased(update<DenseMonitor>), METH_FASTCALL | METH_KEYWORDS,
     "update($self, time, /, **values)\n--\n\n"
     "Take the values of any variables at one instant; return what became known."},
    {nullptr, nullptr, 0, nullptr},
};

PyMethodDef early_methods[] = {
    {"update", erased(update<EarlyBackend>), METH_FASTCALL | METH_KEYWORDS,
     "update($self, time, /, **values)\n--\n\n"
     "Take what is known of the variables at one time; return what became known."},
    {nullptr, nullptr, 0, nullptr},
};

template <class Backend>
int traverse(PyObject* self, visitproc visit, void* arg) {
    Py_VISIT(Py_TYPE(self));
    return nb::inst_ready(self) ? nb::inst_ptr<Online<Backend>>(self)->traverse(visit, arg) : 0;
}

template <class Backend>
int clear(PyObject* self) {
    if (nb::inst_ready(self)) nb::inst_ptr<Online<Backend>>(self)->clear();
    return 0;
}

template <class Backend>
PyType_Slot* slots(PyMethodDef* table) {
    static PyType_Slot slots[] = {
        {Py_tp_methods, static_cast<void*>(table)},
        {Py_tp_traverse, reinterpret_cast<void*>(traverse<Backend>)},
        {Py_tp_clear, reinterpret_cast<void*>(clear<Backend>)},
        {0, nullptr},
    };
    return slots;
}

template <class Backend>
void add(nb::module_& module, const char* name, const char* doc, PyMethodDef* table) {
    LockedClass<Online<Backend>>(module, name, nb::type_slots(slots<Backend>(table)), doc)
        .def(nb::init<>())
        .def_prop_rw("_backend", &Online<Backend>::backend, &Online<Backend>::connect,
                     nb::for_setter(nb::arg("backend").none()), "What takes the samples.");
}

} // namespace

void add_online(nb::module_& module) {
    known() = {module.attr("Refused").ptr(), module.attr("Undefined").ptr()};
    add<Monitor>(module, "MonitorBase", "Takes samples in discrete time.", methods);
    add<DenseMonitor>(module, "DenseMonitorBase", "Takes samples in dense time.", dense_methods);
    add<EarlyBackend>(module, "EarlyMonitorBase", "Takes samples for early verdicts.",
                      early_methods);
}

} // namespace rtamt::python
