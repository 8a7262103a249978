#include "fleet.hpp"

#include "../fleet/fleet.hpp"
#include "arrays.hpp"
#include "calls.hpp"
#include "fleet_batches.hpp"
#include "locked_class.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

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
