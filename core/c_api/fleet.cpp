// The C API of fleets.
#include "fleet_boundary.hpp"

#include <limits>
#include <string_view>
#include <vector>

using namespace rtamt::c_api;
using rtamt::Metadata;
using rtamt::Program;
using rtamt::fleet::Batch;
using rtamt::fleet::Fleet;
using rtamt::fleet::KeySpan;
using rtamt::fleet::Output;

struct rtamt_fleet {
    rtamt_fleet(Metadata&& of, Fleet&& made) : metadata(std::move(of)), fleet(std::move(made)) {}

    Metadata metadata;
    Fleet fleet;
    std::string message;
    const char* shown = ""; // the message, or a sentence that needs no memory
    std::vector<double> values;
    std::vector<double> times;
    std::vector<std::uint8_t> flags;
};

namespace {

void update(rtamt_fleet& handle, const KeySpan& keys, const double* times,
            const double* const* columns, rtamt_fleet_value* results, std::size_t outputs,
            std::size_t* rejected) {
    const std::size_t count = keys.size();
    put(rejected, count);
    const Program& program = handle.fleet.program();
    const std::size_t all = program.outputs.size();
    if (outputs > all) {
        throw std::invalid_argument("The program has " + std::to_string(all) + " outputs, not " +
                                    std::to_string(outputs) + ".");
    }
    Batch batch{keys, items(times, count, "The times").data(),
                items(columns, count == 0 ? 0 : program.inputs, "The columns")};
    for (const double* column : batch.columns)
        (void)items(column, count, "The values of a column");
    (void)items(results, count * outputs, "The places for the results");
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
    if (const auto why = handle.fleet.update(batch, places)) {
        put(rejected, why->index);
        throw RejectedBatch(sentence_of(handle.metadata, handle.fleet.settings(), batch, *why,
                                        at_index(why->index)),
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

} // namespace

extern "C" {

rtamt_status rtamt_fleet_create(const void* program, size_t size, size_t capacity, double tolerance,
                                rtamt_fleet** fleet, char* message, size_t room) {
    return create(program, size, capacity, tolerance, fleet, message, room,
                  [](Program&& parsed, const auto& names, const Fleet::Settings& settings) {
                      return Fleet(std::move(parsed), names, settings);
                  });
}

rtamt_status rtamt_fleet_restore(const void* program, size_t size, const void* state,
                                 size_t state_size, size_t capacity, double tolerance,
                                 rtamt_fleet** fleet, char* message, size_t room) {
    return create(program, size, capacity, tolerance, fleet, message, room,
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

rtamt_status rtamt_fleet_update(rtamt_fleet* fleet, const int64_t* keys, const double* times,
                                const double* const* columns, size_t count,
                                rtamt_fleet_value* results, size_t outputs, size_t* rejected) {
    return error_boundary(fleet, [&](rtamt_fleet& self) {
        update(self, span_of(keys, count), times, columns, results, outputs, rejected);
    });
}

rtamt_status rtamt_fleet_update_text(rtamt_fleet* fleet, const char* const* keys,
                                     const double* times, const double* const* columns,
                                     size_t count, rtamt_fleet_value* results, size_t outputs,
                                     size_t* rejected) {
    return error_boundary(fleet, [&](rtamt_fleet& self) {
        std::vector<std::string_view> held;
        update(self, span_of(keys, count, held), times, columns, results, outputs, rejected);
    });
}

rtamt_status rtamt_fleet_drop(rtamt_fleet* fleet, const int64_t* keys, size_t count) {
    return error_boundary(fleet,
                          [&](rtamt_fleet& self) { drop(self.fleet, span_of(keys, count)); });
}

rtamt_status rtamt_fleet_drop_text(rtamt_fleet* fleet, const char* const* keys, size_t count) {
    return error_boundary(fleet, [&](rtamt_fleet& self) {
        std::vector<std::string_view> held;
        drop(self.fleet, span_of(keys, count, held));
    });
}

rtamt_status rtamt_fleet_expire(rtamt_fleet* fleet, double before, size_t* dropped) {
    return error_boundary(fleet,
                          [&](rtamt_fleet& self) { put(dropped, self.fleet.expire(before)); });
}

size_t rtamt_fleet_size(const rtamt_fleet* fleet) {
    return fleet == nullptr ? 0 : fleet->fleet.size();
}

rtamt_status rtamt_fleet_save(rtamt_fleet* fleet, void* state, size_t room, size_t* size) {
    return error_boundary(fleet, [&](rtamt_fleet& self) {
        save(
            state, room, size, [&] { return self.fleet.snapshot_size(); },
            [&](std::span<std::uint8_t> out) { self.fleet.snapshot(out); });
    });
}

} // extern "C"
