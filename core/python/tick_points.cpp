#include "tick_points.hpp"

#include "cpython.hpp"
#include "method_table.hpp"

#include <cstdint>
#include <cstring>

namespace rtamt::python {

namespace {

// Of the module, which outlives every call; interned.
struct Names {
    nb::handle events;
    nb::handle scale;
    nb::handle rate;
    nb::handle many_points;
};
Names& names() noexcept {
    static Names names;
    return names;
}

// Ticks and rates up to here are doubles, too.
constexpr std::int64_t exact = 9'007'199'254'740'992; // 2^53

// The time of a tick as Python divides integers: rounded once.
[[nodiscard]] nb::object time_of(std::int64_t tick, nb::handle rate) noexcept {
    if (-exact <= tick && tick <= exact) {
        const long long divisor = PyLong_AsLongLong(rate.ptr());
        if (0 < divisor && divisor <= exact) {
            return nb::steal(
                PyFloat_FromDouble(static_cast<double>(tick) / static_cast<double>(divisor)));
        }
        PyErr_Clear();
    }
    const auto number = nb::steal(PyLong_FromLongLong(tick));
    if (!number.is_valid()) return {};
    return nb::steal(PyNumber_TrueDivide(number.ptr(), rate.ptr()));
}

PyObject* points(PyObject* self, PyObject* /*unused*/) noexcept {
    constexpr Py_ssize_t one = sizeof(std::int64_t) + sizeof(double);
    const auto events = nb::steal(PyObject_GetAttr(self, names().events.ptr()));
    if (!events.is_valid()) return nullptr;
    if (!PyBytes_CheckExact(events.ptr())) {
        return PyErr_Format(PyExc_TypeError, "The events are not bytes.");
    }
    const Py_ssize_t size = PyBytes_Size(events.ptr());
    if (size == 0) return PyList_New(0);
    const auto scale = nb::steal(PyObject_GetAttr(self, names().scale.ptr()));
    if (!scale.is_valid()) return nullptr;
    const auto rate = nb::steal(PyObject_GetAttr(scale.ptr(), names().rate.ptr()));
    if (!rate.is_valid()) return nullptr;
    if (size != one || !PyLong_CheckExact(rate.ptr())) {
        return PyObject_CallMethodObjArgs(self, names().many_points.ptr(), nullptr);
    }
    const char* memory = bytes_memory(events.ptr());
    std::int64_t tick = 0;
    double value = 0.0;
    std::memcpy(&tick, memory, sizeof tick);
    std::memcpy(&value, memory + sizeof tick, sizeof value);
    const nb::object time = time_of(tick, rate);
    if (!time.is_valid()) return nullptr;
    const auto number = nb::steal(PyFloat_FromDouble(value));
    if (!number.is_valid()) return nullptr;
    auto pair = nb::steal(PyTuple_Pack(2, time.ptr(), number.ptr()));
    if (!pair.is_valid()) return nullptr;
    PyObject* list = PyList_New(1);
    if (list != nullptr) fill_list(list, 0, pair.release().ptr());
    return list;
}

PyMethodDef methods[] = {
    {"points", erased(points), METH_NOARGS,
     "points($self, /)\n--\n\n"
     "Return (time, value) pairs of Python's own numbers."},
    {nullptr, nullptr, 0, nullptr},
};

PyType_Slot slots[] = {
    {Py_tp_methods, static_cast<void*>(methods)},
    {0, nullptr},
};

PyType_Spec spec = {"rtamt.engine._core.TickPoints", 0, 0, Py_TPFLAGS_DEFAULT | Py_TPFLAGS_BASETYPE,
                    slots};

[[nodiscard]] nb::handle interned(const char* text) {
    return nb::steal(PyUnicode_InternFromString(text)).release();
}

} // namespace

void add_tick_points(const nb::module_& m) {
    names() = {interned("_events"), interned("_scale"), interned("rate"), interned("_many_points")};
    auto type = nb::steal(PyType_FromSpec(&spec));
    if (!type.is_valid()) throw nb::python_error();
    m.attr("TickPoints") = type;
}

} // namespace rtamt::python
