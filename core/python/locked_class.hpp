// A Python class whose methods lock their object.
//
// Without a GIL, two threads can be inside one object at once. Each method and property therefore
// runs in a critical section of its object. Such a section behaves as the GIL does: it is suspended
// where Python code runs and where the thread waits or calls without_gil(). What is correct with
// the GIL is correct with it, too. In an interpreter with a GIL it is nothing.
#pragma once

#include <nanobind/nanobind.h>

#include <utility>

namespace rtamt::python {

namespace nb = nanobind;

template <class Type, class... Bases>
class LockedClass {
  public:
    template <class... Extra>
    LockedClass(nb::handle scope, const char* name, const Extra&... extra)
        : class_(scope, name, extra...) {}

    template <class... Arguments>
    LockedClass& def(nb::init<Arguments...> init) {
        class_.def(std::move(init));
        return *this;
    }

    template <class Function, class... Extra>
    LockedClass& def(const char* name, Function&& function, const Extra&... extra) {
        class_.def(name, std::forward<Function>(function), nb::lock_self(), extra...);
        return *this;
    }

    template <class Getter, class... Extra>
    LockedClass& def_prop_ro(const char* name, Getter&& getter, const Extra&... extra) {
        class_.def_prop_ro(name, std::forward<Getter>(getter), nb::lock_self(), extra...);
        return *this;
    }

    template <class Getter, class Setter, class... Extra>
    LockedClass& def_prop_rw(const char* name, Getter&& getter, Setter&& setter,
                             const Extra&... extra) {
        class_.def_prop_rw(name, std::forward<Getter>(getter), std::forward<Setter>(setter),
                           nb::lock_self(), extra...);
        return *this;
    }

  private:
    nb::class_<Type, Bases...> class_;
};

} // namespace rtamt::python
