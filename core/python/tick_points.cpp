#include "tick_points.hpp"

#include "../values/ticks.hpp"
#include "cpython.hpp"
#include "method_table.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>

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

// Whether `ticks::seconds_of` is what TimeScale.times() makes of a tick: numbers in a unit of the
// caller may be larger than times in seconds.
[[nodiscard]] bool in_seconds(std::int64_t tick, std::int64_t rate) noexcept {
    const double size = std::fabs(static_cast<double>(tick));
    return size < ticks::near || size < ticks::implausible * static_cast<double>(rate);
}

// The divisor from ticks to the times of a scale, or nothing: their times are not quotients of
// doubles.
[[nodiscard]] std::optional<std::int64_t> rate_of(nb::handle scale) noexcept {
    const auto rate = nb::steal(PyObject_GetAttr(scale.ptr(), names().rate.ptr()));
    if (!rate.is_valid() || !PyLong_CheckExact(rate.ptr())) return std::nullopt;
    const long long divisor = PyLong_AsLongLong(rate.ptr());
    if (divisor == -1 && PyErr_Occurred() != nullptr) PyErr_Clear(); // larger than that
    if (divisor <= 0 || static_cast<double>(divisor) > ticks::exact) return std::nullopt;
    return divisor;
}

[[nodiscard]] nb::object pair_of(double time, double value) noexcept {
    const auto first = nb::steal(PyFloat_FromDouble(time));
    const auto second = nb::steal(PyFloat_FromDouble(value));
    if (!first.is_valid() || !second.is_valid()) return {};
    return nb::steal(PyTuple_Pack(2, first.ptr(), second.ptr()));
}

template <class Item>
[[nodiscard]] Item item_at(const char* memory, std::size_t i) noexcept {
    Item item{};
    std::memcpy(&item, memory + i * sizeof(Item), sizeof(Item));
    return item;
}

// Points at times that are quotients of doubles; others are left to Python.
PyObject* points(PyObject* self, PyObject* /*unused*/) noexcept {
    const auto events = nb::steal(PyObject_GetAttr(self, names().events.ptr()));
    if (!events.is_valid()) return nullptr;
    if (!PyBytes_CheckExact(events.ptr())) {
        return PyErr_Format(PyExc_TypeError, "The events are not bytes.");
    }
    const auto size = static_cast<std::size_t>(PyBytes_Size(events.ptr()));
    const std::size_t count = size / (sizeof(std::int64_t) + sizeof(double));
    if (count == 0) return PyList_New(0);
    const auto scale = nb::steal(PyObject_GetAttr(self, names().scale.ptr()));
    if (!scale.is_valid()) return nullptr;
    const auto rate = rate_of(scale);
    if (PyErr_Occurred() != nullptr) return nullptr;
    const char* times = bytes_memory(events.ptr());
    const char* values = times + count * sizeof(std::int64_t);
    nb::object list = nb::steal(PyList_New(static_cast<Py_ssize_t>(count)));
    if (!list.is_valid()) return nullptr;
    for (std::size_t i = 0; i < count; ++i) {
        const auto tick = item_at<std::int64_t>(times, i);
        if (!rate || !in_seconds(tick, *rate)) {
            return PyObject_CallMethodObjArgs(self, names().many_points.ptr(), nullptr);
        }
        nb::object pair = pair_of(ticks::seconds_of(tick, *rate), item_at<double>(values, i));
        if (!pair.is_valid()) return nullptr;
        fill_list(list.ptr(), static_cast<Py_ssize_t>(i), pair.release().ptr());
    }
    return list.release().ptr();
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
