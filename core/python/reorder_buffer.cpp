#include "reorder_buffer.hpp"

#include "../fleet/reorder_buffer.hpp"
#include "arrays.hpp"
#include "fleet_batches.hpp"
#include "locked_class.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <new>
#include <span>
#include <string>
#include <vector>

namespace rtamt::python {

namespace {

using fleet::ReorderBuffer;

template <class Value>
[[nodiscard]] nb::object array_of(const std::vector<Value>& values) {
    auto* copy = new std::vector<Value>(values);
    const nb::capsule owner(
        copy, [](void* memory) noexcept { delete static_cast<std::vector<Value>*>(memory); });
    return nb::cast(
        nb::ndarray<nb::numpy, Value, nb::ndim<1>>(copy->data(), {copy->size()}, owner));
}

[[nodiscard]] nb::object offer(ReorderBuffer& self, const nb::object& keys, const In<double>& times,
                               const std::vector<Column>& columns, const Out<std::uint8_t>& late) {
    const GivenKeys given(keys);
    const std::size_t count = given.span().size();
    if (times.shape(0) != count || late.shape(0) != count) {
        throw std::invalid_argument("The arrays of a batch differ in length.");
    }
    const auto pointers = pointers_of(columns, self.ready().columns.size(), count);
    const fleet::Batch batch{given.span(), times.data(), pointers};
    return rejection_of(without_gil(count, [&] { return self.offer(batch, late.data()); }));
}

[[nodiscard]] nb::object ready(const ReorderBuffer& self) {
    const ReorderBuffer::Ready& ready = self.ready();
    nb::list columns;
    for (const auto& column : ready.columns)
        columns.append(array_of(column));
    return nb::make_tuple(array_of(ready.places), array_of(ready.own), array_of(ready.fills),
                          array_of(ready.times), columns);
}

[[nodiscard]] nb::object keys_at(const ReorderBuffer& self, const In<std::int64_t>& places) {
    nb::list list;
    for (std::size_t i = 0; i < places.shape(0); ++i) {
        const auto place = static_cast<std::size_t>(places.data()[i]);
        if (place >= self.size()) throw std::invalid_argument("There is no key at this place.");
        list.append(key_of(self.keys(), place));
    }
    return list;
}

[[nodiscard]] nb::object left(ReorderBuffer& self, const nb::object& keys) {
    const GivenKeys given(keys);
    std::vector<std::uint8_t> found;
    for (std::size_t i = 0; i < given.span().size(); ++i) {
        const auto place = self.place_of(given.span(), i);
        found.push_back(static_cast<std::uint8_t>(place && self.has_left(*place)));
    }
    return array_of(found);
}

} // namespace

void add_reorder_buffer(const nb::module_& m) {
    LockedClass<ReorderBuffer>(m, "ReorderBuffer",
                               "Puts samples in order, by key; see rtamt.fleet.late_data.")
        .def(
            "__init__",
            [](ReorderBuffer* self, std::vector<std::string> names, std::optional<double> lateness,
               std::size_t capacity, double period, double tolerance, std::size_t filled,
               const std::optional<nb::bytes>& state) {
                const ReorderBuffer::Settings settings{lateness, capacity, period, tolerance,
                                                       filled};
                if (!state) {
                    new (self) ReorderBuffer(std::move(names), settings);
                    return;
                }
                const std::span bytes(static_cast<const std::uint8_t*>(state->data()),
                                      state->size());
                new (self) ReorderBuffer(ReorderBuffer::restore(std::move(names), settings, bytes));
            },
            nb::arg("names"), nb::arg("lateness").none(), nb::arg("capacity"), nb::arg("period"),
            nb::arg("tolerance"), nb::arg("filled"), nb::arg("state") = nb::none())
        .def("offer", &offer, nb::arg("keys"), nb::arg("times"), nb::arg("columns"),
             nb::arg("late"),
             "Take a batch and note which samples are late. Returns None, or why it was rejected.")
        .def(
            "advance",
            [](ReorderBuffer& self, double watermark) {
                return rejection_of(self.advance(watermark));
            },
            nb::arg("watermark"), "Let leave what is not after a time.")
        .def(
            "release",
            [](ReorderBuffer& self, const nb::object& keys) {
                return rejection_of(self.release(GivenKeys(keys).span()));
            },
            nb::arg("keys"), "Let leave all that waits of some keys.")
        .def("ready", &ready,
             "What has left: places, whether of the batch, whether in a gap, times, columns.")
        .def("accept", &ReorderBuffer::accept, "Keep the batch that was offered.")
        .def("withdraw", &ReorderBuffer::withdraw, "Forget the batch that was offered.")
        .def(
            "drop",
            [](ReorderBuffer& self, const nb::object& keys) {
                return self.drop(GivenKeys(keys).span());
            },
            nb::arg("keys"),
            "Forget keys; return the index of the first that is not there, and forget none then.")
        .def(
            "discard",
            [](ReorderBuffer& self, const nb::object& key, double time) {
                return self.discard(GivenKeys(key).span(), time);
            },
            nb::arg("key"), nb::arg("time"),
            "Forget the sample of a key and a time that waits; return whether there was one.")
        .def(
            "stale",
            [](const ReorderBuffer& self, double before) {
                nb::list list;
                for (const std::uint32_t place : self.stale(before))
                    list.append(key_of(self.keys(), place));
                return list;
            },
            nb::arg("before"), "The keys whose newest sample is before a time.")
        .def(
            "contains",
            [](ReorderBuffer& self, const nb::object& keys) {
                return self.place_of(GivenKeys(keys).span(), 0).has_value();
            },
            nb::arg("keys"), "Whether the first key of an array is there.")
        .def("left", &left, nb::arg("keys"), "By key, whether a sample of it has left.")
        .def(
            "keys", [](const ReorderBuffer& self) { return keys_of(self.keys()); }, "All keys.")
        .def("keys_at", &keys_at, nb::arg("places"), "The keys at places.")
        .def(
            "snapshot",
            [](const ReorderBuffer& self) {
                const auto bytes = self.snapshot();
                return nb::bytes(bytes.data(), bytes.size());
            },
            "What waits.")
        .def_prop_ro("size", &ReorderBuffer::size, "How many keys there are.")
        .def_prop_ro("waiting", &ReorderBuffer::waiting, "How many samples wait.")
        .def_prop_ro("late", &ReorderBuffer::late, "How many samples were late.")
        .def_prop_ro("state_bytes", &ReorderBuffer::bytes, "Bytes by now.");
}

} // namespace rtamt::python
