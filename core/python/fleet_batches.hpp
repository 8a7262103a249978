// Batches of samples for a fleet, as numpy has them: keys, and why one was rejected.
#pragma once

#include "../fleet/batch.hpp"
#include "arrays.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace rtamt::python {

namespace nb = nanobind;

template <class Value>
using In = nb::ndarray<const Value, nb::ndim<1>, nb::c_contig, nb::device::cpu>;
template <class Value>
using Rows = nb::ndarray<const Value, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
template <class Value>
using Out = nb::ndarray<Value, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

inline void append_utf8(std::uint32_t point, std::string& out) {
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
            span_.kind = fleet::KeyKind::integer;
            span_.integers = {integers_.data(), integers_.shape(0)};
        } else if (Rows<std::uint8_t> bytes; nb::try_cast(keys, bytes, false)) {
            held_ = keys;
            span_.kind = fleet::KeyKind::bytes;
            for (std::size_t i = 0; i < bytes.shape(0); ++i) {
                const std::size_t width = bytes.shape(1);
                const auto* row = reinterpret_cast<const char*>(bytes.data() + i * width);
                texts_.push_back(trimmed({row, width}));
            }
            span_.texts = texts_;
        } else if (Rows<std::uint32_t> points; nb::try_cast(keys, points, false)) {
            span_.kind = fleet::KeyKind::text;
            read(points);
        } else {
            throw std::invalid_argument("Keys are an array of int64, or of characters.");
        }
    }

    [[nodiscard]] const fleet::KeySpan& span() const noexcept { return span_; }

  private:
    In<std::int64_t> integers_;
    nb::object held_;
    std::string utf8_;
    std::vector<std::string_view> texts_;
    fleet::KeySpan span_;

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

[[nodiscard]] inline const char* name_of(fleet::Rejected::Reason reason) noexcept {
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

// None, or a tuple of what is wrong.
[[nodiscard]] inline nb::object rejection_of(const std::optional<fleet::Rejected>& rejected) {
    if (!rejected) return nb::none();
    return nb::make_tuple(rejected->index, name_of(rejected->reason), rejected->samples,
                          rejected->last, rejected->instruction, rejected->time);
}

[[nodiscard]] inline nb::object key_of(const fleet::Keys& keys, std::size_t place) {
    if (!keys.textual()) return nb::int_(static_cast<std::int64_t>(keys.integers()[place]));
    const std::string& text = keys.texts()[place];
    if (keys.kind() == fleet::KeyKind::bytes) return nb::bytes(text.data(), text.size());
    auto string = nb::steal(
        PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "surrogatepass"));
    if (!string.is_valid()) throw nb::python_error();
    return string;
}

[[nodiscard]] inline nb::object keys_of(const fleet::Keys& keys) {
    nb::list list;
    for (std::size_t place = 0; place < keys.size(); ++place)
        list.append(key_of(keys, place));
    return list;
}

} // namespace rtamt::python
