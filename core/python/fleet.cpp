#include "fleet.hpp"

#include "../fleet/fleet.hpp"
#include "arrays.hpp"
#include "calls.hpp"
#include "locked_class.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <new>
#include <span>
#include <string>
#include <string_view>

namespace rtamt::python {

namespace {

using fleet::Fleet;
using fleet::KeyKind;
using fleet::KeySpan;

template <class Value>
using In = nb::ndarray<const Value, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
template <class Value>
using Rows = nb::ndarray<const Value, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
template <class Value>
using Out = nb::ndarray<Value, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

void append_utf8(std::uint32_t point, std::string& out) {
    const auto tail = [&](unsigned shift) {
        out.push_back(static_cast<char>(0x80U | ((point >> shift) & 0x3FU)));
    };
    if (point < 0x80U) {
        out.push_back(static_cast<char>(point));
    } else if (point < 0x800U) {
        out.push_back(static_cast<char>(0xC0U | (point >> 6U)));
        tail(0);
    } else if (point < 0x10000U) {
        out.push_back(static_cast<char>(0xE0U | (point >> 12U)));
        tail(6);
        tail(0);
    } else {
        out.push_back(static_cast<char>(0xF0U | ((point >> 18U) & 7U)));
        tail(12);
        tail(6);
        tail(0);
    }
}

// The keys of an array: int64, or characters in rows of a fixed width, padded with 0, as numpy
// stores texts (uint32) and bytes (uint8).
class GivenKeys {
  public:
    explicit GivenKeys(const nb::object& keys) {
        if (nb::try_cast(keys, integers_, false)) {
            span_.kind = KeyKind::integer;
            span_.integers = {integers_.data(), integers_.shape(0)};
        } else if (Rows<std::uint8_t> bytes; nb::try_cast(keys, bytes, false)) {
            held_ = keys;
            span_.kind = KeyKind::bytes;
            for (std::size_t i = 0; i < bytes.shape(0); ++i) {
                const std::size_t width = bytes.shape(1);
                const auto* row = reinterpret_cast<const char*>(bytes.data() + i * width);
                texts_.push_back(trimmed({row, width}));
            }
            span_.texts = texts_;
        } else if (Rows<std::uint32_t> points; nb::try_cast(keys, points, false)) {
            span_.kind = KeyKind::text;
            read(points);
        } else {
            throw std::invalid_argument("Keys are an array of int64, or of characters.");
        }
    }

    [[nodiscard]] const KeySpan& span() const noexcept { return span_; }

  private:
    In<std::int64_t> integers_;
    nb::object held_;
    std::string utf8_;
    std::vector<std::string_view> texts_;
    KeySpan span_;

    [[nodiscard]] static std::string_view trimmed(std::string_view text) noexcept {
        const std::size_t last = text.find_last_not_of('\0');
        return text.substr(0, last == std::string_view::npos ? 0 : last + 1);
    }

    void read(const Rows<std::uint32_t>& points) {
        const std::size_t width = points.shape(1);
        std::vector<std::size_t> ends;
        ends.reserve(points.shape(0));
        utf8_.reserve(points.size());
        for (std::size_t i = 0; i < points.shape(0); ++i) {
            std::span<const std::uint32_t> row(points.data() + i * width, width);
            while (!row.empty() && row.back() == 0)
                row = row.first(row.size() - 1);
            for (const std::uint32_t point : row)
                append_utf8(point, utf8_);
            ends.push_back(utf8_.size());
        }
        std::size_t begin = 0;
        texts_.reserve(ends.size());
        for (const std::size_t end : ends) {
            texts_.push_back(std::string_view(utf8_).substr(begin, end - begin));
            begin = end;
        }
        span_.texts = texts_;
    }
};

struct OutArrays {
    Out<double> values;
    Out<std::uint8_t> known;
    Out<double> when;
    Out<std::uint8_t> warming;
};

[[nodiscard]] const char* name_of(fleet::Rejected::Reason reason) noexcept {
    using Reason = fleet::Rejected::Reason;
    switch (reason) {
    case Reason::time:
        return "time";
    case Reason::gap:
        return "gap";
    case Reason::value:
        return "value";
    case Reason::undefined:
        return "undefined";
    case Reason::full:
        break;
    }
    return "full";
}

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
    if (!rejected) return nb::none();
    return nb::make_tuple(rejected->index, name_of(rejected->reason), rejected->samples,
                          rejected->last, rejected->instruction, rejected->time);
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

[[nodiscard]] nb::object keys_of(const Fleet& self) {
    const fleet::Keys& keys = self.keys();
    nb::list list;
    if (keys.kind() == KeyKind::bytes) {
        for (const std::string& text : keys.texts())
            list.append(nb::bytes(text.data(), text.size()));
    } else if (keys.kind() == KeyKind::text) {
        for (const std::string& text : keys.texts()) {
            auto string = nb::steal(PyUnicode_DecodeUTF8(
                text.data(), static_cast<Py_ssize_t>(text.size()), "surrogatepass"));
            if (!string.is_valid()) throw nb::python_error();
            list.append(string);
        }
    } else {
        for (const std::uint64_t key : keys.integers())
            list.append(static_cast<std::int64_t>(key));
    }
    return list;
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
        .def("keys", &keys_of, "All keys.")
        .def("snapshot", &snapshot, "The state of all keys.")
        .def_prop_ro("size", &Fleet::size, "How many keys there are.")
        .def_prop_ro(
            "capacity", [](const Fleet& self) { return self.settings().capacity; },
            "How many keys there may be.")
        .def_prop_ro("record_size", &Fleet::record_size, "Bytes of state a key.")
        .def_prop_ro("state_bytes", &Fleet::bytes, "Bytes of state by now.");
}

} // namespace rtamt::python
