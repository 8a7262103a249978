#include "update_signal.hpp"

#include "../values/ticks.hpp"
#include "cpython.hpp"
#include "method_table.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <span>
#include <stdexcept>
#include <utility>

namespace rtamt::python {

namespace {

// Of the module, which outlives every call; interned.
nb::handle& many_points() noexcept {
    static nb::handle name;
    return name;
}

// ---- the object ---------------------------------------------------------------------------------

constexpr std::size_t few = 3; // most updates make no more points known

// What an object has behind the slots of the base.
struct Points {
    PyObject* scale;
    std::int64_t rate; // ticks in a unit of time; 0: times are no quotients of doubles
    std::size_t count;
    void* memory; // of more than a few points: ticks, then values
    std::int64_t few_ticks[few];
    double few_values[few];

    [[nodiscard]] std::int64_t* ticks() noexcept {
        return memory == nullptr ? few_ticks : static_cast<std::int64_t*>(memory);
    }
    [[nodiscard]] double* values() noexcept {
        return memory == nullptr ? few_values : reinterpret_cast<double*>(ticks() + count);
    }
};
static_assert(sizeof(std::int64_t) == sizeof(double));

[[nodiscard]] Points& points_of(PyObject* self) noexcept {
    return *static_cast<Points*>(own_data(self, sizeof(Points)));
}

// Calls `visit` with each slot of the base; what follows the last one is its padding, and null.
template <class Visit>
int each_slot(PyObject* self, Visit&& visit) {
    const std::span slots(reinterpret_cast<PyObject**>(self + 1),
                          reinterpret_cast<PyObject**>(&points_of(self)));
    for (PyObject*& slot : slots) {
        if (const int result = visit(slot)) return result;
    }
    return 0;
}

int traverse(PyObject* self, visitproc visit, void* arg) {
    Py_VISIT(Py_TYPE(self));
    Py_VISIT(points_of(self).scale);
    return each_slot(self, [&](PyObject* item) { return item == nullptr ? 0 : visit(item, arg); });
}

int clear(PyObject* self) {
    return each_slot(self, [](PyObject*& item) {
        Py_CLEAR(item);
        return 0;
    });
}

// Objects are not tracked by the garbage collector: what they refer to does not refer to them.
void dealloc(PyObject* self) {
    PyTypeObject* type = Py_TYPE(self);
    const Points& points = points_of(self);
    (void)clear(self);
    Py_XDECREF(points.scale);
    if (points.memory != nullptr) [[unlikely]] {
        PyMem_Free(points.memory);
    }
    PyObject_GC_Del(self);
    Py_DECREF(type);
}

// ---- what Python reads --------------------------------------------------------------------------

PyObject* events(PyObject* self, void* /*unused*/) noexcept {
    Points& points = points_of(self);
    const std::size_t half = points.count * sizeof(double);
    PyObject* bytes = PyBytes_FromStringAndSize(nullptr, static_cast<Py_ssize_t>(2 * half));
    if (bytes == nullptr || half == 0) return bytes;
    std::memcpy(bytes_memory(bytes), points.ticks(), half);
    std::memcpy(bytes_memory(bytes) + half, points.values(), half);
    return bytes;
}

PyObject* scale(PyObject* self, void* /*unused*/) noexcept {
    return nb::borrow(points_of(self).scale).release().ptr();
}

Py_ssize_t length(PyObject* self) noexcept {
    return static_cast<Py_ssize_t>(points_of(self).count);
}

// Whether `ticks::seconds_of` is what TimeScale.times() makes of a tick: numbers in a unit of the
// caller may be larger than times in seconds.
[[nodiscard]] bool in_seconds(std::int64_t tick, std::int64_t rate) noexcept {
    const double size = std::fabs(static_cast<double>(tick));
    return size < ticks::near || size < ticks::implausible * static_cast<double>(rate);
}

[[nodiscard]] nb::object pair_of(double time, double value) noexcept {
    const auto first = nb::steal(PyFloat_FromDouble(time));
    const auto second = nb::steal(PyFloat_FromDouble(value));
    if (!first.is_valid() || !second.is_valid()) return {};
    return nb::steal(PyTuple_Pack(2, first.ptr(), second.ptr()));
}

PyObject* read_points(PyObject* self, PyObject* /*unused*/) noexcept {
    Points& points = points_of(self);
    const std::int64_t* ticks = points.ticks();
    const double* values = points.values();
    const auto plain = [&](std::int64_t tick) { return in_seconds(tick, points.rate); };
    if (points.rate == 0 || !std::all_of(ticks, ticks + points.count, plain)) {
        return PyObject_CallMethodObjArgs(self, many_points().ptr(), nullptr);
    }
    nb::object list = nb::steal(PyList_New(static_cast<Py_ssize_t>(points.count)));
    for (std::size_t i = 0; list.is_valid() && i < points.count; ++i) {
        nb::object pair = pair_of(ticks::seconds_of(ticks[i], points.rate), values[i]);
        if (!pair.is_valid()) return nullptr;
        fill_list(list.ptr(), static_cast<Py_ssize_t>(i), pair.release().ptr());
    }
    return list.release().ptr();
}

// ---- the class ----------------------------------------------------------------------------------

[[nodiscard]] std::ptrdiff_t number(const nb::handle& type, const char* name) {
    return nb::cast<std::ptrdiff_t>(nb::getattr(type, name));
}

// Whether every word of an instance behind its head is a slot.
[[nodiscard]] bool has_slots_alone(const nb::handle& type) {
    std::size_t slots = 0;
    for (const nb::handle each : nb::getattr(type, "__mro__")) {
        slots += nb::len(nb::getattr(each, "__slots__", nb::make_tuple()));
    }
    const std::size_t size = sizeof(PyObject) + slots * sizeof(PyObject*);
    return number(type, "__dictoffset__") == 0 && number(type, "__weakrefoffset__") == 0 &&
           number(type, "__itemsize__") == 0 && std::cmp_equal(number(type, "__basicsize__"), size);
}

PyMethodDef methods[] = {
    {"points", erased(read_points), METH_NOARGS,
     "points($self, /)\n--\n\n"
     "Return (time, value) pairs of Python's own numbers."},
    {nullptr, nullptr, 0, nullptr},
};

PyGetSetDef attributes[] = {
    {"_events", events, nullptr, "The ticks and then the values, as bytes.", nullptr},
    {"_scale", scale, nullptr, "The format of times.", nullptr},
    {nullptr, nullptr, nullptr, nullptr, nullptr},
};

PyType_Slot slots[] = {
    {Py_tp_methods, static_cast<void*>(methods)},
    {Py_tp_getset, static_cast<void*>(attributes)},
    {Py_tp_dealloc, reinterpret_cast<void*>(dealloc)},
    {Py_tp_traverse, reinterpret_cast<void*>(traverse)},
    {Py_tp_clear, reinterpret_cast<void*>(clear)},
    {Py_sq_length, reinterpret_cast<void*>(length)},
    {0, nullptr},
};

[[nodiscard]] nb::object update_signal_class(const nb::type_object& base) {
    if (!has_slots_alone(base)) {
        throw std::invalid_argument("The base of an update signal has more than slots.");
    }
    PyType_Spec spec = {"rtamt.engine._core.UpdateSignal",
                        basicsize_of(number(base, "__basicsize__"), sizeof(Points)), 0,
                        Py_TPFLAGS_DEFAULT | Py_TPFLAGS_HAVE_GC | Py_TPFLAGS_DISALLOW_INSTANTIATION,
                        slots};
    nb::object type = nb::steal(PyType_FromSpecWithBases(&spec, nb::make_tuple(base).ptr()));
    if (!type.is_valid()) throw nb::python_error();
    return type;
}

// The divisor from ticks to the times of a scale; 0 if their times are no quotients of doubles.
[[nodiscard]] std::int64_t rate_of(const nb::object& scale) {
    std::int64_t rate = 0;
    const bool whole = nb::try_cast(nb::getattr(scale, "rate"), rate);
    return whole && rate > 0 && rate <= static_cast<std::int64_t>(ticks::exact) ? rate : 0;
}

} // namespace

UpdateSignals::UpdateSignals(const nb::type_object& type, const nb::object& scale)
    : type_(type), scale_(scale), rate_(rate_of(scale)) {
    auto* own = reinterpret_cast<PyTypeObject*>(type.ptr());
    if (PyType_GetSlot(own, Py_tp_dealloc) != reinterpret_cast<void*>(dealloc)) {
        throw std::invalid_argument("The class of the results is none of update_signal_class().");
    }
}

PyObject* UpdateSignals::make(const dense::Events& events) const noexcept {
    void* memory = nullptr;
    if (events.count > few) {
        memory = PyMem_Malloc(2 * events.count * sizeof(double));
        if (memory == nullptr) return PyErr_NoMemory();
    }
    PyObject* self = PyObject_GC_New(PyObject, reinterpret_cast<PyTypeObject*>(type_.ptr()));
    if (self == nullptr) {
        PyMem_Free(memory);
        return nullptr;
    }
    Points& points = points_of(self);
    (void)each_slot(self, [](PyObject*& item) {
        item = nullptr;
        return 0;
    });
    points.scale = nb::borrow(scale_).release().ptr();
    points.rate = rate_;
    points.count = events.count;
    points.memory = memory;
    std::copy_n(events.times, events.count, points.ticks());
    std::copy_n(events.values, events.count, points.values());
    return self;
}

void add_update_signal(nb::module_& m) {
    many_points() = nb::steal(PyUnicode_InternFromString("_many_points")).release();
    if (!many_points().is_valid()) throw nb::python_error();
    m.def("update_signal_class", &update_signal_class, nb::arg("base"),
          "Return the class of results of updates in dense time: a base whose instances have "
          "nothing but slots, with the points in the object.");
}

} // namespace rtamt::python
