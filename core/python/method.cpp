#include "method.hpp"

#include "dense_monitor.hpp"
#include "early_monitor.hpp"
#include "monitor.hpp"

#include <structmember.h>

#include <cstddef>
#include <cstring>
#include <span>

namespace rtamt::python {

namespace {

// What a call passes beside the object: values by position, then those that have names.
struct Arguments {
    std::span<PyObject* const> positional;
    Named named;
};

using Take = PyObject* (*)(PyObject* backend, const Arguments& arguments) noexcept;

// Null without an exception where the arguments are not of the ordinary form.
template <class Monitor>
PyObject* update(PyObject* backend, const Arguments& arguments) noexcept {
    if (arguments.positional.size() != 1) return nullptr;
    return nb::inst_ptr<Monitor>(backend)->update(arguments.positional[0], arguments.named);
}

PyObject* step(PyObject* backend, // NOLINT(misc-const-correctness): as the other kinds
               const Arguments& arguments) noexcept {
    if (arguments.named.count() != 0) return nullptr;
    return nb::inst_ptr<Monitor>(backend)->step(arguments.positional);
}

struct Kind {
    const char* name;
    const char* of;
    Take take;
};

constexpr Kind kinds[] = {
    {"update", "Monitor", update<Monitor>},
    {"step", "Monitor", step},
    {"dense_update", "DenseMonitor", update<DenseMonitor>},
    {"early_update", "EarlyMonitor", update<EarlyMonitor>},
};

struct Method {
    PyObject_HEAD PyObject* function;
    PyObject* backend_name;
    PyObject* backend_type;
    PyObject* refused;
    PyObject* undefined;
    PyObject* dict;
    vectorcallfunc vectorcall;
    Take take;
};

[[nodiscard]] Method& of(PyObject* self) noexcept {
    return *reinterpret_cast<Method*>(self);
}

// Whether the function can say more of the failure than the exception that is set.
[[nodiscard]] bool has_more_to_say(const Method& method) noexcept {
    if (PyErr_Occurred() == nullptr) return true;
    if (PyErr_ExceptionMatches(method.refused) == 0 &&
        PyErr_ExceptionMatches(method.undefined) == 0) {
        return false;
    }
    PyErr_Clear();
    return true;
}

PyObject* call(PyObject* self, PyObject* const* args, std::size_t flags, PyObject* names) {
    const Method& method = of(self);
    const auto count = static_cast<std::size_t>(PyVectorcall_NARGS(flags));
    if (count > 0) {
        const auto backend = nb::steal(PyObject_GetAttr(args[0], method.backend_name));
        if (!backend.is_valid()) return nullptr;
        if (reinterpret_cast<PyObject*>(Py_TYPE(backend.ptr())) == method.backend_type &&
            nb::inst_ready(backend)) [[likely]] {
            PyObject* result =
                method.take(backend.ptr(), {{args + 1, count - 1}, {names, args + count}});
            if (result != nullptr || !has_more_to_say(method)) return result;
        }
    }
    return PyObject_Vectorcall(method.function, args, flags, names);
}

PyObject* make(PyTypeObject* type, PyObject* args, PyObject* /*keywords*/) {
    PyObject* function = nullptr;
    const char* name = nullptr;
    if (PyArg_ParseTuple(args, "Os", &function, &name) == 0) return nullptr;
    for (const Kind& kind : kinds) {
        if (std::strcmp(kind.name, name) != 0) continue;
        PyObject* module = PyType_GetModule(type);
        auto self = nb::steal(type->tp_alloc(type, 0));
        if (module == nullptr || !self.is_valid()) return nullptr;
        Method& method = of(self.ptr());
        method.function = Py_NewRef(function);
        method.backend_name = PyUnicode_InternFromString("_backend");
        method.backend_type = PyObject_GetAttrString(module, kind.of);
        method.refused = PyObject_GetAttrString(module, "Refused");
        method.undefined = PyObject_GetAttrString(module, "Undefined");
        method.vectorcall = call;
        method.take = kind.take;
        return PyErr_Occurred() == nullptr ? self.release().ptr() : nullptr;
    }
    return PyErr_Format(PyExc_ValueError, "There is no method '%s'.", name);
}

PyObject* bind(PyObject* self, PyObject* object, PyObject* /*type*/) {
    return object == nullptr ? Py_NewRef(self) : PyMethod_New(self, object);
}

int traverse(PyObject* self, visitproc visit, void* arg) {
    const Method& method = of(self);
    Py_VISIT(Py_TYPE(self));
    Py_VISIT(method.function);
    Py_VISIT(method.backend_type);
    Py_VISIT(method.refused);
    Py_VISIT(method.undefined);
    Py_VISIT(method.dict);
    return 0;
}

int clear(PyObject* self) {
    Method& method = of(self);
    Py_CLEAR(method.function);
    Py_CLEAR(method.backend_name);
    Py_CLEAR(method.backend_type);
    Py_CLEAR(method.refused);
    Py_CLEAR(method.undefined);
    Py_CLEAR(method.dict);
    return 0;
}

void destroy(PyObject* self) {
    PyTypeObject* type = Py_TYPE(self);
    PyObject_GC_UnTrack(self);
    (void)clear(self);
    type->tp_free(self);
    Py_DECREF(type);
}

PyMemberDef members[] = {
    {"__vectorcalloffset__", T_PYSSIZET, offsetof(Method, vectorcall), READONLY, nullptr},
    {"__dictoffset__", T_PYSSIZET, offsetof(Method, dict), READONLY, nullptr},
    {nullptr, 0, 0, 0, nullptr},
};

PyGetSetDef properties[] = {
    {"__dict__", PyObject_GenericGetDict, PyObject_GenericSetDict, nullptr, nullptr},
    {nullptr, nullptr, nullptr, nullptr, nullptr},
};

PyType_Slot slots[] = {
    {Py_tp_doc,
     const_cast<char*>("Method(function, kind, /)\n--\n\n"
                       "A function of a class that is called only where the compiled monitor in "
                       "`_backend` does not take the arguments by itself.")},
    {Py_tp_new, reinterpret_cast<void*>(make)},
    {Py_tp_call, reinterpret_cast<void*>(PyVectorcall_Call)},
    {Py_tp_descr_get, reinterpret_cast<void*>(bind)},
    {Py_tp_traverse, reinterpret_cast<void*>(traverse)},
    {Py_tp_clear, reinterpret_cast<void*>(clear)},
    {Py_tp_dealloc, reinterpret_cast<void*>(destroy)},
    {Py_tp_members, static_cast<void*>(members)},
    {Py_tp_getset, static_cast<void*>(properties)},
    {0, nullptr},
};

PyType_Spec spec = {"rtamt.engine._core.Method", sizeof(Method), 0,
                    Py_TPFLAGS_DEFAULT | Py_TPFLAGS_HAVE_GC | Py_TPFLAGS_HAVE_VECTORCALL |
                        Py_TPFLAGS_METHOD_DESCRIPTOR,
                    slots};

} // namespace

void add_method_type(const nb::module_& module) {
    const auto type = nb::steal(PyType_FromModuleAndSpec(module.ptr(), &spec, nullptr));
    if (!type.is_valid()) throw nb::python_error();
    module.attr("Method") = type;
}

} // namespace rtamt::python
