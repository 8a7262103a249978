// The C API of fleets: with records, in discrete time and delayed, or with a monitor for each key.
#include "fleet_boundary.hpp"

#include "../fleet/monitors.hpp"

#include <array>
#include <bit>
#include <limits>
#include <string_view>
#include <variant>
#include <vector>

using namespace rtamt::c_api;
using rtamt::Metadata;
using rtamt::Program;
using rtamt::fleet::AtStart;
using rtamt::fleet::Batch;
using rtamt::fleet::Fleet;
using rtamt::fleet::Keys;
using rtamt::fleet::KeySpan;
using rtamt::fleet::MonitorBatch;
using rtamt::fleet::MonitorProgram;
using rtamt::fleet::Monitors;
using rtamt::fleet::Output;
using rtamt::fleet::Rejected;
using rtamt::fleet::Row;

struct rtamt_fleet {
    rtamt_fleet(Metadata&& of, Fleet&& made) : metadata(std::move(of)), fleet(std::move(made)) {}
    explicit rtamt_fleet(Monitors&& made) : fleet(std::move(made)) {}

    Metadata metadata; // of records
    std::variant<Fleet, Monitors> fleet;
    std::string message;
    const char* shown = ""; // the message, or a sentence that needs no memory
    std::vector<double> values;
    std::vector<double> times;
    std::vector<std::uint8_t> flags;
    std::vector<rtamt_fleet_row> rows;
    std::vector<std::uint8_t> late;  // by sample of the last batch
    std::vector<std::uint8_t> saved; // the state whose size was asked for, until anything changes

    [[nodiscard]] const Monitors* monitors() const noexcept {
        return std::get_if<Monitors>(&fleet);
    }
    [[nodiscard]] Monitors* monitors() noexcept { return std::get_if<Monitors>(&fleet); }
    [[nodiscard]] Fleet& records() { return std::get<Fleet>(fleet); }
    [[nodiscard]] const Keys& keys() const noexcept {
        const Monitors* made = monitors();
        return made != nullptr ? made->keys() : std::get_if<Fleet>(&fleet)->keys();
    }
    [[nodiscard]] std::size_t inputs() const noexcept {
        return monitors() != nullptr ? monitors()->program().inputs.size() : metadata.inputs.size();
    }
    [[nodiscard]] std::size_t outputs() const noexcept {
        return monitors() != nullptr ? values_of(monitors()->program().mode)
                                     : metadata.outputs.size();
    }
};

namespace {

constexpr double no_time = std::numeric_limits<double>::quiet_NaN();

constexpr const char* compiled_for_fleets = "compile it for a fleet, with rtamt compile --fleet.";

// The names of the two values at the start of the trace, by mode.
constexpr std::array<std::array<const char*, 2>, 4> names_at_start{
    {{nullptr, nullptr}, {nullptr, nullptr}, {"lower", "upper"}, {"violation", "satisfaction"}}};

void require_outputs(const rtamt_fleet& handle, std::size_t outputs) {
    if (outputs > handle.outputs()) {
        throw std::invalid_argument("The program has " + std::to_string(handle.outputs()) +
                                    " outputs, not " + std::to_string(outputs) + ".");
    }
}

void require_watermark(double time) {
    if (std::isfinite(time)) return;
    throw std::invalid_argument("The watermark is not finite: give a number of seconds.");
}

[[nodiscard]] KeySpan keys_of(const rtamt_fleet& handle, const rtamt_fleet_batch& batch,
                              std::vector<std::string_view>& held) {
    if (batch.keys != nullptr && batch.texts != nullptr) {
        throw std::invalid_argument("The batch has keys and texts: give one of them.");
    }
    return batch.texts != nullptr ? span_of(batch.texts, batch.count, handle.keys(), held)
                                  : span_of(batch.keys, batch.count);
}

// The columns of a batch, which may be null.
template <class Column>
[[nodiscard]] std::span<const Column* const> columns_of(const Column* const* columns,
                                                        std::size_t inputs) noexcept {
    return columns == nullptr ? std::span<const Column* const>()
                              : std::span<const Column* const>(columns, inputs);
}

// ---- records ------------------------------------------------------------------------------------

// Throws for what records do not take.
void require_plain(const rtamt_fleet& handle, const rtamt_fleet_batch& batch) {
    if (batch.uppers != nullptr) {
        throw std::invalid_argument("Delayed verdicts need exact values: give no upper bounds.");
    }
    for (const std::uint8_t* column : columns_of(batch.given, handle.inputs())) {
        if (column == nullptr) continue;
        for (std::size_t i = 0; i < batch.count; ++i) {
            if (column[i] == 0) {
                throw std::invalid_argument("Delayed verdicts in discrete time need a value of "
                                            "each input: leave the sample out.");
            }
        }
    }
}

void take_records(rtamt_fleet& handle, const KeySpan& keys, const rtamt_fleet_batch& given,
                  rtamt_fleet_value* results, std::size_t outputs, std::size_t* rejected) {
    require_plain(handle, given);
    const std::size_t count = keys.size();
    Fleet& fleet = handle.records();
    const Batch batch{keys, given.times, columns_of(given.columns, handle.inputs())};
    for (const double* column : batch.columns)
        (void)items(column, count, "The values of a column");
    require_seconds(batch, rejected);
    require_truths(handle.metadata, batch, rejected);
    const std::size_t all = handle.outputs();
    handle.values.resize(count * all);
    handle.times.resize(count * all);
    handle.flags.resize(2 * count * all);
    std::vector<Output> places;
    places.reserve(all);
    for (std::size_t k = 0; k < all; ++k) {
        places.push_back({handle.values.data() + k * count, handle.flags.data() + k * count,
                          handle.times.data() + k * count,
                          handle.flags.data() + (all + k) * count});
    }
    if (const auto why = fleet.update(batch, places)) {
        put(rejected, why->index);
        throw RejectedBatch(
            sentence_of(handle.metadata, fleet.settings(), batch, *why, at_index(why->index)),
            *why);
    }
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t k = 0; k < outputs; ++k) {
            const Output& from = places[k];
            results[i * outputs + k] = {from.values[i], from.when[i], from.known[i],
                                        from.warming[i]};
        }
    }
}

// ---- monitors -----------------------------------------------------------------------------------

[[noreturn]] void reject(const Monitors::Wrong& wrong) {
    const auto reason = wrong.undefined ? Rejected::Reason::undefined : Rejected::Reason::value;
    throw RejectedBatch(wrong.sentence, Rejected{.index = wrong.index, .reason = reason});
}

// Puts what a call has made known where the caller reads it.
void deliver(rtamt_fleet& handle, const Monitors::Report& report, rtamt_fleet_value* results,
             std::size_t outputs) {
    handle.rows.resize(report.rows.size());
    for (std::size_t i = 0; i < report.at_start.size(); ++i) {
        const AtStart& at_start = report.at_start[i];
        for (std::size_t k = 0; k < outputs; ++k) {
            results[i * outputs + k] = {at_start.values[k], no_time, 1, 0};
        }
    }
    handle.late.clear();
    for (const AtStart& at_start : report.at_start)
        handle.late.push_back(at_start.late ? 1 : 0);
    for (std::size_t i = 0; i < report.rows.size(); ++i) {
        const Row& row = report.rows[i];
        handle.rows[i] = {row.index,           row.begin,        row.end,
                          row.bounds.lower,    row.bounds.upper, row.decided_at,
                          row.is_final ? 1 : 0};
    }
}

void take_monitors(rtamt_fleet& handle, const KeySpan& keys, const rtamt_fleet_batch& given,
                   rtamt_fleet_value* results, std::size_t outputs, std::size_t* rejected) {
    Monitors& fleet = *handle.monitors();
    const MonitorProgram::Mode mode = fleet.program().mode;
    if (given.uppers != nullptr &&
        (mode == MonitorProgram::Mode::delayed || mode == MonitorProgram::Mode::causation)) {
        throw std::invalid_argument("Bounds as values are for eager and interval verdicts: give "
                                    "no upper bounds.");
    }
    const MonitorBatch batch{keys, given.times, columns_of(given.columns, handle.inputs()),
                             columns_of(given.uppers, handle.inputs()),
                             columns_of(given.given, handle.inputs())};
    const auto look = [&](const Monitors::Report& report) {
        deliver(handle, report, results, outputs);
    };
    if (const auto wrong = fleet.update(batch, look)) {
        put(rejected, wrong->index);
        reject(*wrong);
    }
}

void take(rtamt_fleet& handle, const KeySpan& keys, const rtamt_fleet_batch& batch,
          rtamt_fleet_value* results, std::size_t outputs, std::size_t* rejected) {
    const std::size_t count = keys.size();
    put(rejected, count);
    handle.saved = {};
    require_outputs(handle, outputs);
    require_texts(keys, rejected);
    (void)items(batch.times, count, "The times");
    (void)items(batch.columns, count == 0 ? 0 : handle.inputs(), "The columns");
    (void)items(results, count * outputs, "The places for the results");
    if (handle.monitors() != nullptr) {
        take_monitors(handle, keys, batch, results, outputs, rejected);
    } else {
        take_records(handle, keys, batch, results, outputs, rejected);
    }
}

// A batch without missing values.
[[nodiscard]] rtamt_fleet_batch full(const double* times, const double* const* columns,
                                     std::size_t count) noexcept {
    return {count, nullptr, nullptr, times, columns, nullptr, nullptr};
}

void require_columns(const rtamt_fleet& handle, const double* const* columns, std::size_t count) {
    for (const double* column : items(columns, count == 0 ? 0 : handle.inputs(), "The columns"))
        (void)items(column, count, "The values of a column");
}

// A handle with monitors, where the program is one of them; whether it is.
template <class Make>
[[nodiscard]] std::optional<rtamt_status> create_monitors(const void* program, std::size_t size,
                                                          rtamt_fleet** fleet, char* message,
                                                          std::size_t room, const Make& make) {
    if (fleet == nullptr || !MonitorProgram::begins(bytes(program, size))) return std::nullopt;
    *fleet = nullptr;
    return guarded(
        [&] { *fleet = new rtamt_fleet(make(MonitorProgram::parse(bytes(program, size)))); },
        [&](const char* sentence) { copy_message(sentence, message, room); });
}

} // namespace

extern "C" {

rtamt_status rtamt_fleet_create(const void* program, size_t size, size_t capacity, double tolerance,
                                rtamt_fleet** fleet, char* message, size_t room) {
    if (const auto status =
            create_monitors(program, size, fleet, message, room, [&](MonitorProgram&& parsed) {
                return Monitors(std::move(parsed), capacity);
            })) {
        return *status;
    }
    return create(program, size, capacity, tolerance, fleet, message, room, compiled_for_fleets,
                  [](Program&& parsed, const auto& names, const Fleet::Settings& settings) {
                      return Fleet(std::move(parsed), names, settings);
                  });
}

rtamt_status rtamt_fleet_restore(const void* program, size_t size, const void* state,
                                 size_t state_size, size_t capacity, double tolerance,
                                 rtamt_fleet** fleet, char* message, size_t room) {
    if (const auto status =
            create_monitors(program, size, fleet, message, room, [&](MonitorProgram&& parsed) {
                return Monitors::restore(std::move(parsed), capacity, bytes(state, state_size));
            })) {
        return *status;
    }
    return create(program, size, capacity, tolerance, fleet, message, room, compiled_for_fleets,
                  [&](Program&& parsed, const auto& names, const Fleet::Settings& settings) {
                      return Fleet::restore(std::move(parsed), names, settings,
                                            bytes(state, state_size));
                  });
}

void rtamt_fleet_destroy(rtamt_fleet* fleet) { // NOLINT(misc-const-correctness): the C API
    delete fleet;
}

const char* rtamt_fleet_message(const rtamt_fleet* fleet) {
    return fleet == nullptr ? "There is no fleet: it was not created." : fleet->shown;
}

rtamt_mode rtamt_fleet_mode(const rtamt_fleet* fleet) {
    if (fleet == nullptr) return RTAMT_NO_MODE;
    const Monitors* monitors = fleet->monitors();
    return monitors == nullptr ? RTAMT_DELAYED : static_cast<rtamt_mode>(monitors->program().mode);
}

rtamt_domain rtamt_fleet_time(const rtamt_fleet* fleet) {
    if (fleet == nullptr) return RTAMT_NO_DOMAIN;
    const Monitors* monitors = fleet->monitors();
    return monitors == nullptr ? RTAMT_DISCRETE
                               : static_cast<rtamt_domain>(monitors->program().domain);
}

uint32_t rtamt_fleet_inputs(const rtamt_fleet* fleet) {
    return fleet == nullptr ? 0 : static_cast<uint32_t>(fleet->inputs());
}

uint32_t rtamt_fleet_outputs(const rtamt_fleet* fleet) {
    return fleet == nullptr ? 0 : static_cast<uint32_t>(fleet->outputs());
}

const char* rtamt_fleet_input(const rtamt_fleet* fleet, uint32_t input) {
    if (input >= rtamt_fleet_inputs(fleet)) return nullptr;
    const Monitors* monitors = fleet->monitors();
    return monitors == nullptr ? fleet->metadata.inputs[input].c_str()
                               : monitors->program().inputs[input].name.c_str();
}

const char* rtamt_fleet_output(const rtamt_fleet* fleet, uint32_t output) {
    if (output >= rtamt_fleet_outputs(fleet)) return nullptr;
    const Monitors* monitors = fleet->monitors();
    if (monitors == nullptr) return fleet->metadata.outputs[output].c_str();
    return names_at_start[static_cast<std::size_t>(monitors->program().mode)][output];
}

rtamt_status rtamt_fleet_take(rtamt_fleet* fleet, const rtamt_fleet_batch* batch,
                              rtamt_fleet_value* results, size_t outputs, size_t* rejected) {
    return error_boundary(fleet, [&](rtamt_fleet& self) {
        put(rejected, batch == nullptr ? 0 : batch->count);
        if (batch == nullptr) throw std::invalid_argument("The batch is null: pass an address.");
        std::vector<std::string_view> held;
        take(self, keys_of(self, *batch, held), *batch, results, outputs, rejected);
    });
}

rtamt_status rtamt_fleet_update(rtamt_fleet* fleet, const int64_t* keys, const double* times,
                                const double* const* columns, size_t count,
                                rtamt_fleet_value* results, size_t outputs, size_t* rejected) {
    return error_boundary(fleet, [&](rtamt_fleet& self) {
        put(rejected, count);
        const KeySpan given = span_of(keys, count);
        require_columns(self, columns, count);
        take(self, given, full(times, columns, count), results, outputs, rejected);
    });
}

rtamt_status rtamt_fleet_update_text(rtamt_fleet* fleet, const char* const* keys,
                                     const double* times, const double* const* columns,
                                     size_t count, rtamt_fleet_value* results, size_t outputs,
                                     size_t* rejected) {
    return error_boundary(fleet, [&](rtamt_fleet& self) {
        put(rejected, count);
        std::vector<std::string_view> held;
        const KeySpan given = span_of(keys, count, self.keys(), held);
        require_columns(self, columns, count);
        take(self, given, full(times, columns, count), results, outputs, rejected);
    });
}

rtamt_status rtamt_fleet_watermark(rtamt_fleet* fleet, double time, rtamt_fleet_value* results,
                                   size_t outputs) {
    return error_boundary(fleet, [&](rtamt_fleet& self) {
        Monitors* monitors = self.monitors();
        if (monitors == nullptr) {
            throw std::invalid_argument("Delayed verdicts in discrete time have no watermark: use "
                                        "a stream.");
        }
        self.saved = {};
        require_outputs(self, outputs);
        require_watermark(time);
        (void)items(results, monitors->size() * outputs, "The places for the results");
        const auto look = [&](const Monitors::Report& report) {
            deliver(self, report, results, outputs);
        };
        if (const auto wrong = monitors->watermark(time, look)) reject(*wrong);
    });
}

size_t rtamt_fleet_rows(const rtamt_fleet* fleet, const rtamt_fleet_row** rows) {
    if (fleet == nullptr) return 0;
    put(rows, fleet->rows.data());
    return fleet->rows.size();
}

uint64_t rtamt_fleet_late(const rtamt_fleet* fleet) {
    return fleet == nullptr || fleet->monitors() == nullptr ? 0 : fleet->monitors()->late();
}

int32_t rtamt_fleet_is_late(const rtamt_fleet* fleet, size_t index) {
    return fleet == nullptr || index >= fleet->late.size() ? 0 : fleet->late[index];
}

rtamt_status rtamt_fleet_drop(rtamt_fleet* fleet, const int64_t* keys, size_t count) {
    return error_boundary(fleet, [&](rtamt_fleet& self) {
        self.saved = {};
        std::visit([&](auto& made) { drop(made, span_of(keys, count)); }, self.fleet);
    });
}

rtamt_status rtamt_fleet_drop_text(rtamt_fleet* fleet, const char* const* keys, size_t count) {
    return error_boundary(fleet, [&](rtamt_fleet& self) {
        self.saved = {};
        std::vector<std::string_view> held;
        std::visit([&](auto& made) { drop(made, span_of(keys, count, self.keys(), held)); },
                   self.fleet);
    });
}

rtamt_status rtamt_fleet_expire(rtamt_fleet* fleet, double before, size_t* dropped) {
    return error_boundary(fleet, [&](rtamt_fleet& self) {
        self.saved = {};
        put(dropped, std::visit([&](auto& made) { return made.expire(before); }, self.fleet));
    });
}

size_t rtamt_fleet_size(const rtamt_fleet* fleet) {
    return fleet == nullptr ? 0 : fleet->keys().size();
}

int rtamt_fleet_key(const rtamt_fleet* fleet, size_t index, int64_t* key, const char** text) {
    if (index >= rtamt_fleet_size(fleet)) return 0;
    const Keys& keys = fleet->keys();
    put(key, keys.textual() ? 0 : std::bit_cast<std::int64_t>(keys.integers()[index]));
    put(text, keys.textual() ? keys.texts()[index].c_str() : nullptr);
    return 1;
}

rtamt_status rtamt_fleet_save(rtamt_fleet* fleet, void* state, size_t room, size_t* size) {
    return error_boundary(fleet, [&](rtamt_fleet& self) {
        if (const Monitors* monitors = self.monitors()) {
            if (self.saved.empty()) self.saved = monitors->snapshot();
            save(
                state, room, size, [&] { return self.saved.size(); },
                [&](std::span<std::uint8_t> out) {
                    std::ranges::copy(self.saved, out.begin());
                    self.saved = {};
                });
            return;
        }
        Fleet& records = self.records();
        save(
            state, room, size, [&] { return records.snapshot_size(); },
            [&](std::span<std::uint8_t> out) { records.snapshot(out); });
    });
}

} // extern "C"
