// Functions of CPython's stable ABI that CPython itself has as macros without checks.
//
// Wheels for Python 3.12 and newer use the stable ABI, so that one serves all of them; others use
// the macros, which save one to two nanoseconds a call. Callers have checked the types.
#pragma once

#include <nanobind/nanobind.h>

#include <cstddef>

namespace rtamt::python {

#if defined(Py_LIMITED_API)

// The memory of a class itself, behind that of its base, in an object of exactly this class.
inline void* own_data(PyObject* object, std::size_t /*size*/) noexcept {
    return PyObject_GetTypeData(object, Py_TYPE(object));
}
// The size in the specification of a class that adds so many bytes to its base.
inline int basicsize_of(std::ptrdiff_t /*base*/, std::size_t size) noexcept {
    return -static_cast<int>(size);
}

inline double float_value(PyObject* object) noexcept {
    return PyFloat_AsDouble(object);
}
inline Py_ssize_t tuple_size(PyObject* tuple) noexcept {
    return PyTuple_Size(tuple);
}
inline PyObject* tuple_item(PyObject* tuple, Py_ssize_t i) noexcept {
    return PyTuple_GetItem(tuple, i);
}
inline Py_ssize_t dict_size(PyObject* dict) noexcept {
    return PyDict_Size(dict);
}
inline char* bytes_memory(PyObject* bytes) noexcept {
    return PyBytes_AsString(bytes);
}

// Of a list or tuple.
inline Py_ssize_t sequence_size(PyObject* sequence) noexcept {
    return PyList_Check(sequence) ? PyList_Size(sequence) : PyTuple_Size(sequence);
}
inline PyObject* sequence_item(PyObject* sequence, Py_ssize_t i) noexcept {
    return PyList_Check(sequence) ? PyList_GetItem(sequence, i) : PyTuple_GetItem(sequence, i);
}

// Puts an item into a new list, which takes it over.
inline void fill_list(PyObject* list, Py_ssize_t i, PyObject* item) noexcept {
    (void)PyList_SetItem(list, i, item);
}

#else

inline void* own_data(PyObject* object, std::size_t size) noexcept {
    return reinterpret_cast<char*>(object) + Py_TYPE(object)->tp_basicsize - size;
}
inline int basicsize_of(std::ptrdiff_t base, std::size_t size) noexcept {
    return static_cast<int>(base) + static_cast<int>(size);
}

inline double float_value(PyObject* object) noexcept {
    return PyFloat_AS_DOUBLE(object);
}
inline Py_ssize_t tuple_size(PyObject* tuple) noexcept {
    return PyTuple_GET_SIZE(tuple);
}
inline PyObject* tuple_item(PyObject* tuple, Py_ssize_t i) noexcept {
    return PyTuple_GET_ITEM(tuple, i);
}
inline Py_ssize_t dict_size(PyObject* dict) noexcept {
    return PyDict_GET_SIZE(dict);
}
inline char* bytes_memory(PyObject* bytes) noexcept {
    return PyBytes_AS_STRING(bytes);
}
inline Py_ssize_t sequence_size(PyObject* sequence) noexcept {
    return PySequence_Fast_GET_SIZE(sequence);
}
inline PyObject* sequence_item(PyObject* sequence, Py_ssize_t i) noexcept {
    return PySequence_Fast_GET_ITEM(sequence, i);
}
inline void fill_list(PyObject* list, Py_ssize_t i, PyObject* item) noexcept {
    PyList_SET_ITEM(list, i, item);
}

#endif

} // namespace rtamt::python
