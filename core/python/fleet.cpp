#include "fleet.hpp"

#include "../fleet/fleet.hpp"
#include "arrays.hpp"
#include "calls.hpp"
#include "fleet_batches.hpp"
#include "locked_class.hpp"
#include "numbers.hpp"
#include "numpy.hpp"
#include "recording.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <new>
#include <span>
#include <string>

namespace rtamt::python {

namespace {

using fleet::Fleet;

struct OutArrays {
    Out<double> values;
    Out<std::uint8_t> known;
    Out<double> when;
    Out<std::uint8_t> warming;
};

[[nodiscard]] nb::object update(Fleet& self, const nb::object& keys, const In<double>& times,
                                const std::vector<Column>& columns, const nb::list& arrays) {
    const GivenKeys given(keys);
    const std::size_t count = given.span().size();
    const auto require = [](bool holds) {
        if (!holds) throw std::invalid_argument("The arrays of a batch differ in length.");
    };
    require(times.shape(0) == count && arrays.size() == self.program().outputs.size());
    const auto pointers = pointers_of(columns, self.program().inputs, count);
    std::vector<fleet::Output> outputs;
    for (const nb::handle each : arrays) {
        const auto tuple = nb::cast<nb::tuple>(each);
        const OutArrays out{nb::cast<Out<double>>(tuple[0]), nb::cast<Out<std::uint8_t>>(tuple[1]),
                            nb::cast<Out<double>>(tuple[2]), nb::cast<Out<std::uint8_t>>(tuple[3])};
        require(out.values.shape(0) == count && out.known.shape(0) == count &&
                out.when.shape(0) == count && out.warming.shape(0) == count);
        outputs.push_back(
            {out.values.data(), out.known.data(), out.when.data(), out.warming.data()});
    }
    const fleet::Batch batch{given.span(), times.data(), pointers};
    const auto rejected = without_gil(count, [&] { return self.update(batch, outputs); });
    return rejection_of(rejected);
}

// What a batch has made known of an output, as numpy has it.
struct MadeArrays {
    nb::tuple arrays;
    fleet::Output output;

    MadeArrays(const NumPy& numpy, std::size_t count) {
        const NewArray values = numpy.make(count);
        const NewBools known = numpy.make_bools(count);
        const NewArray when = numpy.make(count);
        const NewBools warming = numpy.make_bools(count);
        arrays = nb::make_tuple(values.array, known.array, when.array, warming.array);
        output = {values.values(), known.memory, when.values(), warming.memory};
    }
};

// Numbers as Python gave them, copied only if they are no doubles one after another.
class Doubles {
  public:
    Doubles(const NumPy& numpy, nb::object object, std::size_t count)
        : given_(numpy, std::move(object)) {
        if (given_.count() != count) return;
        values_ = given_.in_place();
        if (values_ != nullptr) return;
        copy_ = std::make_unique_for_overwrite<double[]>(count);
        if (given_.copy(copy_.get())) values_ = copy_.get();
    }

    // Null for what has to be converted or rejected.
    [[nodiscard]] const double* values() const noexcept { return values_; }

  private:
    Given given_;
    std::unique_ptr<double[]> copy_;
    const double* values_ = nullptr;
};

// The same as update() for numbers that need no conversion, and times that are seconds. Returns
// what became known of each output, or None, with nothing changed: for other data, and for a batch
// that update() rejects.
[[nodiscard]] nb::object take(Fleet& self, const NumPy& numpy, const nb::object& keys,
                              const nb::object& times, const nb::list& columns) {
    const GivenKeys given(keys);
    const std::size_t count = given.span().size();
    const Doubles moments(numpy, times, count);
    if (moments.values() == nullptr || columns.size() != self.program().inputs) return nb::none();
    const std::span seconds(moments.values(), count);
    if (!std::ranges::all_of(seconds, [](double t) { return std::fabs(t) < implausible; })) {
        return nb::none();
    }
    std::vector<Doubles> held;
    std::vector<const double*> pointers;
    held.reserve(columns.size());
    pointers.reserve(columns.size());
    for (const nb::handle column : columns) {
        held.emplace_back(numpy, nb::borrow(column), count);
        pointers.push_back(held.back().values());
        if (pointers.back() == nullptr) return nb::none();
    }
    nb::list made;
    std::vector<fleet::Output> outputs;
    outputs.reserve(self.program().outputs.size());
    for (std::size_t i = 0; i < self.program().outputs.size(); ++i) {
        const MadeArrays arrays(numpy, count);
        made.append(arrays.arrays);
        outputs.push_back(arrays.output);
    }
    const fleet::Batch batch{given.span(), seconds.data(), pointers};
    if (without_gil(count, [&] { return self.update(batch, outputs); })) return nb::none();
    return made;
}

[[nodiscard]] nb::bytes snapshot(const Fleet& self) {
    const std::size_t size = self.snapshot_size();
    auto bytes =
        nb::steal<nb::bytes>(PyBytes_FromStringAndSize(nullptr, static_cast<Py_ssize_t>(size)));
    if (!bytes.is_valid()) throw nb::python_error();
    auto* memory = reinterpret_cast<std::uint8_t*>(PyBytes_AsString(bytes.ptr()));
    without_gil(size, [&] { self.snapshot({memory, size}); });
    return bytes;
}

[[nodiscard]] Fleet::Settings settings(double period, double tolerance, bool restart,
                                       std::size_t capacity) {
    return {period, tolerance, restart, capacity};
}

} // namespace

void add_fleet(const nb::module_& m) {
    LockedClass<Fleet>(m, "Fleet", "Runs a program for many keys; see rtamt.fleet.")
        .def(
            "__init__",
            [](Fleet* self, const nb::bytes& program, std::vector<std::string> names, double period,
               double tolerance, bool restart, std::size_t capacity,
               const std::optional<nb::bytes>& state) {
                Program parsed = parse(program);
                const auto given = settings(period, tolerance, restart, capacity);
                if (!state) {
                    new (self) Fleet(std::move(parsed), std::move(names), given);
                    return;
                }
                const std::span bytes(static_cast<const std::uint8_t*>(state->data()),
                                      state->size());
                new (self) Fleet(Fleet::restore(std::move(parsed), std::move(names), given, bytes));
            },
            nb::arg("program"), nb::arg("names"), nb::arg("period"), nb::arg("tolerance"),
            nb::arg("restart"), nb::arg("capacity"), nb::arg("state") = nb::none())
        .def("update", &update, nb::arg("keys"), nb::arg("times"), nb::arg("columns"),
             nb::arg("outputs"),
             "Take a batch and fill the arrays of each output: values, known, when, warming. "
             "Returns None, or why it was rejected.")
        .def(
            "take",
            [numpy = NumPy()](Fleet& self, const nb::object& keys, const nb::object& times,
                              const nb::list& columns) {
                return take(self, numpy, keys, times, columns);
            },
            nb::arg("keys"), nb::arg("times").none(), nb::arg("columns"),
            "Take a batch of arrays or lists of numbers. Returns the same arrays of each output; "
            "None, "
            "with nothing changed, for data that has to be converted or rejected.")
        .def(
            "drop",
            [](Fleet& self, const nb::object& keys) { return self.drop(GivenKeys(keys).span()); },
            nb::arg("keys"),
            "Forget keys; return the index of the first that is not there, and forget none then.")
        .def("expire", &Fleet::expire, nb::arg("before"),
             "Forget keys whose last sample is before a time; return how many.")
        .def(
            "contains",
            [](Fleet& self, const nb::object& keys) {
                return self.contains(GivenKeys(keys).span(), 0);
            },
            nb::arg("keys"), "Whether the first key of an array is there.")
        .def(
            "keys", [](const Fleet& self) { return keys_of(self.keys()); }, "All keys.")
        .def(
            "last_times",
            [](Fleet& self) {
                nb::list list;
                for (std::size_t place = 0; place < self.size(); ++place)
                    list.append(self.last_time(place));
                return list;
            },
            "The time of the last sample of each key, in the order of keys().")
        .def("snapshot", &snapshot, "The state of all keys.")
        .def_prop_ro("size", &Fleet::size, "How many keys there are.")
        .def_prop_ro(
            "capacity", [](const Fleet& self) { return self.settings().capacity; },
            "How many keys there may be.")
        .def_prop_ro("record_size", &Fleet::record_size, "Bytes of state a key.")
        .def_prop_ro("state_bytes", &Fleet::bytes, "Bytes of state by now.");
}

} // namespace rtamt::python
