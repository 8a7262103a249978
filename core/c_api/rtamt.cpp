// The C API of monitors.
#include "rtamt.h"

#include "boundary.hpp"
#include "monitor.hpp"

#include <algorithm>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>

using namespace rtamt::c_api;

struct rtamt_monitor {
    explicit rtamt_monitor(std::span<const std::uint8_t> program) : monitor(program) {}
    explicit rtamt_monitor(Monitor& other) : monitor(other) {}

    Monitor monitor;
    Undefined failure{0, 0};
    std::string message;
    const char* shown = ""; // the message, or a sentence that needs no memory
};

namespace {

constexpr const char* no_monitor = "There is no monitor: it was not created.";

void remember(rtamt_monitor& handle, std::string_view sentence) noexcept {
    try {
        handle.message = sentence;
        handle.shown = handle.message.c_str();
    } catch (const std::bad_alloc&) {
        handle.shown = out_of_memory;
    }
}

template <class Work>
[[nodiscard]] rtamt_status error_boundary(rtamt_monitor* handle, Work&& work) noexcept {
    if (handle == nullptr) return RTAMT_REFUSED;
    bool undefined = false;
    const rtamt_status status = guarded(
        [&] {
            try {
                std::forward<Work>(work)(handle->monitor);
            } catch (const Undefined& failure) {
                undefined = true;
                handle->failure = failure;
                remember(*handle, handle->monitor.undefined(failure));
            }
        },
        [&](const char* sentence) { remember(*handle, sentence); });
    return undefined && status == RTAMT_OK ? RTAMT_UNDEFINED : status;
}

template <class List>
[[nodiscard]] const char* name_in(const List& names, std::uint32_t index) noexcept {
    return index < names.size() ? names[index].c_str() : nullptr;
}

} // namespace

extern "C" {

uint32_t rtamt_abi(void) {
    return RTAMT_ABI;
}

rtamt_status rtamt_create(const void* program, size_t size, rtamt_monitor** monitor, char* message,
                          size_t room) {
    const auto say = [&](const char* sentence) { copy_message(sentence, message, room); };
    if (monitor == nullptr) {
        say(no_place);
        return RTAMT_REFUSED;
    }
    *monitor = nullptr;
    return guarded([&] { *monitor = new rtamt_monitor(bytes(program, size)); }, say);
}

void rtamt_destroy(rtamt_monitor* monitor) { // NOLINT(misc-const-correctness): the C API
    delete monitor;
}

const char* rtamt_message(const rtamt_monitor* monitor) {
    return monitor == nullptr ? no_monitor : monitor->shown;
}

rtamt_status rtamt_failure(const rtamt_monitor* monitor, uint32_t* instruction, int64_t* step) {
    if (monitor == nullptr) return RTAMT_REFUSED;
    put(instruction, monitor->failure.instruction);
    put(step, monitor->failure.step);
    return RTAMT_OK;
}

rtamt_domain rtamt_time(const rtamt_monitor* monitor) {
    if (monitor == nullptr) return RTAMT_NO_DOMAIN;
    return static_cast<rtamt_domain>(monitor->monitor.program().domain);
}

const char* rtamt_name(const rtamt_monitor* monitor) {
    return monitor == nullptr ? nullptr : monitor->monitor.metadata().name.c_str();
}

const char* rtamt_formula(const rtamt_monitor* monitor) {
    return monitor == nullptr ? nullptr : monitor->monitor.metadata().formula.c_str();
}

rtamt_status rtamt_period(const rtamt_monitor* monitor, int64_t* numerator, int64_t* denominator) {
    if (monitor == nullptr) return RTAMT_REFUSED;
    put(numerator, monitor->monitor.metadata().numerator);
    put(denominator, monitor->monitor.metadata().denominator);
    return RTAMT_OK;
}

uint32_t rtamt_inputs(const rtamt_monitor* monitor) {
    return monitor == nullptr ? 0 : monitor->monitor.program().inputs;
}

uint32_t rtamt_outputs(const rtamt_monitor* monitor) {
    if (monitor == nullptr) return 0;
    return static_cast<uint32_t>(monitor->monitor.program().outputs.size());
}

uint32_t rtamt_parameters(const rtamt_monitor* monitor) {
    if (monitor == nullptr) return 0;
    return static_cast<uint32_t>(monitor->monitor.metadata().parameters.size());
}

const char* rtamt_input(const rtamt_monitor* monitor, uint32_t input) {
    return monitor == nullptr ? nullptr : name_in(monitor->monitor.metadata().inputs, input);
}

const char* rtamt_output(const rtamt_monitor* monitor, uint32_t output) {
    return monitor == nullptr ? nullptr : name_in(monitor->monitor.metadata().outputs, output);
}

const char* rtamt_parameter(const rtamt_monitor* monitor, uint32_t parameter) {
    if (parameter >= rtamt_parameters(monitor)) return nullptr;
    return monitor->monitor.metadata().parameters[parameter].name.c_str();
}

int64_t rtamt_lag(const rtamt_monitor* monitor, uint32_t output) {
    if (output >= rtamt_outputs(monitor)) return -1;
    const rtamt::Program& program = monitor->monitor.program();
    return program.instructions[program.outputs[output]].lag;
}

rtamt_status rtamt_parameter_value(const rtamt_monitor* monitor, uint32_t parameter,
                                   double* value) {
    if (value == nullptr || parameter >= rtamt_parameters(monitor)) return RTAMT_REFUSED;
    *value = monitor->monitor.parameter(parameter);
    return RTAMT_OK;
}

rtamt_status rtamt_set_parameter(rtamt_monitor* monitor, uint32_t parameter, double value) {
    return error_boundary(monitor, [&](Monitor& self) { self.set_parameter(parameter, value); });
}

rtamt_status rtamt_set_parameter_by_name(rtamt_monitor* monitor, const char* name, double value) {
    return error_boundary(monitor, [&](Monitor& self) {
        if (name == nullptr) throw std::invalid_argument("The name of the parameter is null.");
        self.set_parameter(self.parameter_called(name), value);
    });
}

rtamt_status rtamt_step(rtamt_monitor* monitor, const double* values, size_t count,
                        rtamt_value* results, size_t outputs) {
    return error_boundary(monitor, [&](Monitor& self) {
        self.step(items(values, count, "The values of the sample"),
                  items(results, outputs, "The places for the outputs"));
    });
}

rtamt_status rtamt_push(rtamt_monitor* monitor, const rtamt_sample* samples, size_t count) {
    return error_boundary(monitor,
                          [&](Monitor& self) { self.push(items(samples, count, "The samples")); });
}

rtamt_status rtamt_finish(rtamt_monitor* monitor) {
    return error_boundary(monitor, [](Monitor& self) { self.finish(); });
}

rtamt_status rtamt_reset(rtamt_monitor* monitor) {
    return error_boundary(monitor, [](Monitor& self) { self.reset(); });
}

size_t rtamt_last_output(const rtamt_monitor* monitor, uint32_t output, const int64_t** steps,
                         const double** values) {
    if (output >= rtamt_outputs(monitor)) return 0;
    const rtamt::dense::Events events = monitor->monitor.runner().last_output(output);
    put(steps, events.times);
    put(values, events.values);
    return events.count;
}

int rtamt_known_until(const rtamt_monitor* monitor, uint32_t output, int64_t* step) {
    if (monitor == nullptr) return -1;
    if (output >= rtamt_outputs(monitor)) return 0;
    const auto until = monitor->monitor.runner().known_until(output);
    if (until) put(step, *until);
    return until ? 1 : 0;
}

int64_t rtamt_sample_count(const rtamt_monitor* monitor) {
    return monitor == nullptr ? -1 : monitor->monitor.samples();
}

rtamt_status rtamt_clone(rtamt_monitor* monitor, rtamt_monitor** copy) {
    return error_boundary(monitor, [&](Monitor& self) {
        if (copy == nullptr) throw std::invalid_argument(no_place);
        *copy = nullptr;
        *copy = new rtamt_monitor(self);
    });
}

rtamt_status rtamt_save(rtamt_monitor* monitor, void* state, size_t room, size_t* size) {
    return error_boundary(monitor, [&](Monitor& self) {
        const auto saved = self.save();
        rtamt::c_api::save(
            state, room, size, [&] { return saved.size(); },
            [&](std::span<std::uint8_t> out) { std::ranges::copy(saved, out.begin()); });
    });
}

rtamt_status rtamt_restore(rtamt_monitor* monitor, const void* state, size_t size) {
    return error_boundary(monitor, [&](Monitor& self) { self.restore(bytes(state, size)); });
}

} // extern "C"
