// Attributes of numpy, which is imported when one of them is first needed: a monitor of plain
// numbers starts without it.
#pragma once

#include <nanobind/nanobind.h>

#include <atomic>

namespace rtamt::python {

namespace nb = nanobind;

class NumPyAttribute {
  public:
    explicit constexpr NumPyAttribute(const char* name) noexcept : name_(name) {}

    // Borrowed: it is kept as long as the process. Threads that find it at once store the same.
    [[nodiscard]] PyObject* get() {
        PyObject* found = found_.load(std::memory_order_acquire);
        if (found == nullptr) {
            nb::object attribute = nb::module_::import_("numpy").attr(name_);
            found = attribute.release().ptr();
            found_.store(found, std::memory_order_release);
        }
        return found;
    }

    // Null where numpy was not imported yet, so that no object comes from it.
    [[nodiscard]] PyObject* get_if_imported() noexcept {
        PyObject* found = found_.load(std::memory_order_acquire);
        if (found != nullptr) return found;
        if (PyDict_GetItemString(PyImport_GetModuleDict(), "numpy") == nullptr) return nullptr;
        try {
            return get();
        } catch (const nb::python_error&) {
            return nullptr; // it is being imported, or its import has failed
        }
    }

  private:
    const char* name_;
    std::atomic<PyObject*> found_{nullptr};
};

} // namespace rtamt::python
