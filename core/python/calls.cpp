#include "calls.hpp"

#include "../dense/events.hpp"
#include "arrays.hpp"

#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cstdint>
#include <exception>
#include <initializer_list>
#include <span>
#include <stdexcept>
#include <utility>

namespace rtamt::python {

namespace {

using Times = nb::ndarray<const std::int64_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

constexpr const char* raised = "a Python exception";

// A copy, because the core writes into its memory again.
template <class Item>
[[nodiscard]] nb::object array(const Item* items, std::size_t count) {
    auto memory = std::make_unique_for_overwrite<Item[]>(std::max<std::size_t>(count, 1));
    std::copy_n(items, count, memory.get());
    const nb::capsule owner(memory.get(),
                            [](void* copy) noexcept { delete[] static_cast<Item*>(copy); });
    nb::ndarray<nb::numpy, Item, nb::ndim<1>> result(
        memory.release(), std::initializer_list<std::size_t>{count}, owner);
    return result.cast();
}

} // namespace

// A Python function that makes drivers, as a table of functions. A driver has run or advance, and
// reset, checkpoint and rollback; it checks what the user's class gives.
struct Calls::Driven {
    nb::object make;
    nb::object error; // what was raised last
    rtamt_kernel table{rtamt_kernel_version, this,     create, destroy, reset,
                       checkpoint,           rollback, run,    advance};

    explicit Driven(nb::object function) : make(std::move(function)) {}

    struct State {
        Driven& home;
        nb::object driver;
    };
    std::vector<State*> states;

    // Calls `work` with the GIL; returns null, or that it raised an exception.
    template <class Work>
    static const char* with_python(Driven& home, Work&& work) noexcept {
        const nb::gil_scoped_acquire gil;
        try {
            std::forward<Work>(work)();
            return nullptr;
        } catch (nb::python_error& caught) {
            home.error = nb::borrow(caught.value());
        } catch (const std::exception& caught) {
            home.error = nb::steal(PyObject_CallFunction(PyExc_RuntimeError, "s", caught.what()));
        }
        return raised;
    }

    static State& of(void* state) noexcept { return *static_cast<State*>(state); }

    static void call(void* state, const char* method) noexcept {
        (void)with_python(of(state).home, [&] { of(state).driver.attr(method)(); });
    }

    static void* create(void* context, const rtamt_setup* /*setup*/, const char** error) {
        auto& home = *static_cast<Driven*>(context);
        State* state = nullptr;
        *error = with_python(home, [&] {
            auto made = std::make_unique<State>(home, home.make());
            home.states.push_back(made.get());
            state = made.release();
        });
        return state;
    }

    static void destroy(void* state) {
        const nb::gil_scoped_acquire gil;
        std::erase(of(state).home.states, &of(state));
        delete &of(state);
    }

    static void reset(void* state) { call(state, "reset"); }
    static void checkpoint(void* state) { call(state, "checkpoint"); }
    static void rollback(void* state) { call(state, "rollback"); }

    static const char* run(void* state, const rtamt_samples* samples) {
        return with_python(of(state).home, [&] {
            nb::list operands;
            for (const double* operand : operands_of(state, samples->operands))
                operands.append(array(operand, samples->count));
            const auto result = nb::cast<Column>(
                of(state).driver.attr("run")(operands, samples->last, samples->due));
            if (result.shape(0) != samples->due) throw std::logic_error("wrong number of results");
            std::copy_n(result.data(), samples->due, samples->out);
        });
    }

    static const char* advance(void* state, const rtamt_stretch* stretch) {
        return with_python(of(state).home, [&] {
            nb::list operands;
            for (const rtamt_events& events : operands_of(state, stretch->operands)) {
                operands.append(nb::make_tuple(array(events.times, events.count),
                                               array(events.values, events.count)));
            }
            const auto result = nb::cast<nb::tuple>(of(state).driver.attr("advance")(
                operands, stretch->start, stretch->until, stretch->due));
            const auto times = nb::cast<Times>(result[0]);
            const auto values = nb::cast<Column>(result[1]);
            for (std::size_t i = 0; i < times.shape(0); ++i)
                stretch->emit(stretch->sink, times.data()[i], values.data()[i]);
        });
    }

    template <class Operand>
    static std::span<const Operand> operands_of(void* state, const Operand* operands) {
        return {operands, nb::cast<std::size_t>(of(state).driver.attr("operands"))};
    }
};

void Calls::Drop::operator()(Driven* driven) const noexcept {
    delete driven;
}

Calls::Calls(const nb::list& calls) {
    for (const nb::handle item : calls) {
        const auto call = nb::cast<nb::tuple>(item);
        const auto kernel = nb::cast<nb::object>(call[0]);
        CallSite site;
        site.operands = nb::cast<std::vector<std::uint32_t>>(call[4]);
        site.setup = {nb::cast<std::int64_t>(call[1]), nb::cast<std::int64_t>(call[2]),
                      nb::cast<double>(call[3]), site.operands.size()};
        if (PyCapsule_CheckExact(kernel.ptr()) != 0) {
            site.kernel = static_cast<const rtamt_kernel*>(
                PyCapsule_GetPointer(kernel.ptr(), "rtamt.kernel"));
            if (site.kernel == nullptr) throw nb::python_error();
            capsules_.push_back(kernel);
        } else {
            driven_.emplace_back(new Driven(kernel));
            site.kernel = &driven_.back()->table;
        }
        sites_.push_back(std::move(site));
    }
}

nb::object Calls::take_error() {
    for (const auto& driven : driven_) {
        if (driven->error.is_valid()) return std::exchange(driven->error, nb::object());
    }
    return {};
}

int Calls::traverse(visitproc visit, void* arg) const {
    for (const auto& driven : driven_) {
        Py_VISIT(driven->make.ptr());
        Py_VISIT(driven->error.ptr());
        for (const Driven::State* state : driven->states)
            Py_VISIT(state->driver.ptr());
    }
    return 0;
}

void Calls::clear() noexcept {
    for (const auto& driven : driven_) {
        driven->make = nb::none();
        driven->error.reset();
        for (Driven::State* state : driven->states)
            state->driver = nb::none();
    }
}

void Calls::rethrow() {
    const nb::object error = take_error();
    if (!error.is_valid()) return;
    PyErr_SetObject(error.type().ptr(), error.ptr());
    throw nb::python_error();
}

} // namespace rtamt::python
