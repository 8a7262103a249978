// FMI 2.0 for co-simulation over Component. A rejected step returns fmi2Discard:
// the unit is as it was, and the simulator may try another step.

#include "fmi2.hpp"

#include "component.hpp"
#include "error_boundary.hpp"

#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

using rtamt::fmi::Component;
using rtamt::fmi::error_boundary;
using rtamt::fmi::Outcome;

namespace {

using State = std::vector<std::uint8_t>;

struct Log {
    fmi2CallbackFunctions callbacks;
    std::string name;

    // The logger reads its message as printf does.
    void say(fmi2Status status, const char* sentence) const noexcept {
        if (callbacks.logger == nullptr) return;
        try {
            std::string format;
            for (const char* letter = sentence; *letter != '\0'; ++letter)
                format += *letter == '%' ? std::string("%%") : std::string(1, *letter);
            callbacks.logger(callbacks.componentEnvironment, name.c_str(), status,
                             status == fmi2Discard ? "logStatusDiscard" : "logStatusError",
                             format.c_str());
        } catch (const std::bad_alloc&) {
            callbacks.logger(callbacks.componentEnvironment, name.c_str(), status, "logStatusError",
                             "There is not enough memory.");
        }
    }
};

struct Instance {
    Log log;
    Component component;
};

// Does the work on the component; `refusal` is the status if the component rejects it.
template <class Work>
fmi2Status with(fmi2Component handle, fmi2Status refusal, Work&& work) noexcept {
    if (handle == nullptr) return fmi2Error;
    auto& instance = *static_cast<Instance*>(handle);
    fmi2Status status = fmi2OK;
    (void)error_boundary(
        &instance.component, [&] { work(instance.component); },
        [&](Outcome outcome, const char* sentence) {
            status = outcome == Outcome::refused ? refusal : fmi2Error;
            instance.log.say(status, sentence);
        });
    return status;
}

// Sets inputs and parameters of any type.
template <class Value, class Number = std::identity>
fmi2Status set(fmi2Component instance, const fmi2ValueReference references[], std::size_t count,
               const Value values[], Number number = {}) noexcept {
    return with(instance, fmi2Discard, [&](Component& component) {
        std::vector<double> numbers(count);
        for (std::size_t i = 0; i < count; ++i)
            numbers[i] = static_cast<double>(number(values[i]));
        component.set({references, count}, numbers);
    });
}

fmi2Status refuse(fmi2Component handle, const char* sentence) noexcept {
    if (handle != nullptr) static_cast<Instance*>(handle)->log.say(fmi2Error, sentence);
    return fmi2Error;
}

constexpr const char* no_strings = "This unit has no variables that are text.";
constexpr const char* no_derivatives = "This unit neither takes nor gives derivatives.";
constexpr const char* never_pending = "A step of this unit is never pending.";

} // namespace

// ---- lifecycle ----------------------------------------------------------------------------------

RTAMT_FMI2_EXPORT const char* fmi2GetTypesPlatform() {
    return "default";
}

RTAMT_FMI2_EXPORT const char* fmi2GetVersion() {
    return "2.0";
}

RTAMT_FMI2_EXPORT fmi2Status fmi2SetDebugLogging(fmi2Component /*instance*/, fmi2Boolean /*on*/,
                                                 std::size_t /*count*/,
                                                 const fmi2String /*categories*/[]) {
    return fmi2OK; // logging cannot be switched off: there are only rejections and errors
}

RTAMT_FMI2_EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid,
                                                fmi2String resources,
                                                const fmi2CallbackFunctions* callbacks,
                                                fmi2Boolean /*visible*/, fmi2Boolean /*logging*/) {
    if (callbacks == nullptr) return nullptr;
    Instance* instance = nullptr;
    (void)error_boundary(
        nullptr,
        [&] {
            if (type != fmi2CoSimulation) {
                throw std::invalid_argument("This unit is for co-simulation.");
            }
            if (name == nullptr || guid == nullptr || resources == nullptr) {
                throw std::invalid_argument("The unit needs a name, its GUID and its resources.");
            }
            Component component(rtamt::fmi::path_of(resources), guid);
            instance = new Instance{{*callbacks, name}, std::move(component)};
        },
        [&](Outcome, const char* sentence) {
            const Log log{*callbacks, name == nullptr ? "" : name};
            log.say(fmi2Error, sentence);
        });
    return instance;
}

RTAMT_FMI2_EXPORT void fmi2FreeInstance(fmi2Component instance) {
    delete static_cast<Instance*>(instance);
}

RTAMT_FMI2_EXPORT fmi2Status fmi2SetupExperiment(fmi2Component instance,
                                                 fmi2Boolean /*tolerance_defined*/,
                                                 fmi2Real /*tolerance*/, fmi2Real start,
                                                 fmi2Boolean /*stop_defined*/, fmi2Real /*stop*/) {
    return with(instance, fmi2Error, [&](Component& component) { component.begin(start); });
}

RTAMT_FMI2_EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component instance) {
    return with(instance, fmi2Error, [](Component& component) { component.initialise(); });
}

RTAMT_FMI2_EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component instance) {
    return with(instance, fmi2Error, [](Component& component) { component.settle(); });
}

RTAMT_FMI2_EXPORT fmi2Status fmi2Terminate(fmi2Component instance) {
    return with(instance, fmi2Error, [](Component& component) { component.terminate(); });
}

RTAMT_FMI2_EXPORT fmi2Status fmi2Reset(fmi2Component instance) {
    return with(instance, fmi2Error, [](Component& component) { component.reset(); });
}

// ---- variables ----------------------------------------------------------------------------------

RTAMT_FMI2_EXPORT fmi2Status fmi2GetReal(fmi2Component instance,
                                         const fmi2ValueReference references[], std::size_t count,
                                         fmi2Real values[]) {
    return with(instance, fmi2Error, [&](Component& component) {
        for (std::size_t i = 0; i < count; ++i)
            values[i] = component.real(references[i]);
    });
}

RTAMT_FMI2_EXPORT fmi2Status fmi2GetInteger(fmi2Component instance,
                                            const fmi2ValueReference references[],
                                            std::size_t count, fmi2Integer values[]) {
    return with(instance, fmi2Error, [&](Component& component) {
        for (std::size_t i = 0; i < count; ++i)
            values[i] = component.integer32(references[i]);
    });
}

RTAMT_FMI2_EXPORT fmi2Status fmi2GetBoolean(fmi2Component instance,
                                            const fmi2ValueReference references[],
                                            std::size_t count, fmi2Boolean values[]) {
    return with(instance, fmi2Error, [&](Component& component) {
        for (std::size_t i = 0; i < count; ++i)
            values[i] = component.boolean(references[i]) ? 1 : 0;
    });
}

RTAMT_FMI2_EXPORT fmi2Status fmi2GetString(fmi2Component instance, const fmi2ValueReference[],
                                           std::size_t count, fmi2String[]) {
    return count == 0 ? fmi2OK : refuse(instance, no_strings);
}

RTAMT_FMI2_EXPORT fmi2Status fmi2SetReal(fmi2Component instance,
                                         const fmi2ValueReference references[], std::size_t count,
                                         const fmi2Real values[]) {
    return set(instance, references, count, values);
}

RTAMT_FMI2_EXPORT fmi2Status fmi2SetInteger(fmi2Component instance,
                                            const fmi2ValueReference references[],
                                            std::size_t count, const fmi2Integer values[]) {
    return set(instance, references, count, values);
}

RTAMT_FMI2_EXPORT fmi2Status fmi2SetBoolean(fmi2Component instance,
                                            const fmi2ValueReference references[],
                                            std::size_t count, const fmi2Boolean values[]) {
    return set(instance, references, count, values,
               [](fmi2Boolean value) { return value != 0 ? 1.0 : 0.0; });
}

RTAMT_FMI2_EXPORT fmi2Status fmi2SetString(fmi2Component instance, const fmi2ValueReference[],
                                           std::size_t count, const fmi2String[]) {
    return count == 0 ? fmi2OK : refuse(instance, no_strings);
}

// ---- state --------------------------------------------------------------------------------------

RTAMT_FMI2_EXPORT fmi2Status fmi2GetFMUstate(fmi2Component instance, fmi2FMUstate* state) {
    return with(instance, fmi2Error, [&](Component& component) {
        auto saved = std::make_unique<State>(component.save());
        if (*state == nullptr) {
            *state = saved.release();
        } else {
            *static_cast<State*>(*state) = std::move(*saved);
        }
    });
}

RTAMT_FMI2_EXPORT fmi2Status fmi2SetFMUstate(fmi2Component instance, fmi2FMUstate state) {
    return with(instance, fmi2Error, [&](Component& component) {
        component.restore(*static_cast<const State*>(state));
    });
}

RTAMT_FMI2_EXPORT fmi2Status fmi2FreeFMUstate(fmi2Component /*instance*/, fmi2FMUstate* state) {
    if (state == nullptr) return fmi2OK;
    delete static_cast<State*>(*state);
    *state = nullptr;
    return fmi2OK;
}

RTAMT_FMI2_EXPORT fmi2Status fmi2SerializedFMUstateSize(fmi2Component /*instance*/,
                                                        fmi2FMUstate state, std::size_t* size) {
    *size = static_cast<const State*>(state)->size();
    return fmi2OK;
}

RTAMT_FMI2_EXPORT fmi2Status fmi2SerializeFMUstate(fmi2Component instance, fmi2FMUstate state,
                                                   fmi2Byte bytes[], std::size_t size) {
    const State& saved = *static_cast<const State*>(state);
    if (size < saved.size()) return refuse(instance, "The state needs more bytes than there are.");
    std::memcpy(bytes, saved.data(), saved.size());
    return fmi2OK;
}

RTAMT_FMI2_EXPORT fmi2Status fmi2DeSerializeFMUstate(fmi2Component instance, const fmi2Byte bytes[],
                                                     std::size_t size, fmi2FMUstate* state) {
    return with(instance, fmi2Error, [&](Component&) {
        const std::span<const fmi2Byte> read(bytes, size);
        *state = new State(read.begin(), read.end()); // looked at when it is set
    });
}

// ---- steps --------------------------------------------------------------------------------------

RTAMT_FMI2_EXPORT fmi2Status fmi2DoStep(fmi2Component instance, fmi2Real time, fmi2Real length,
                                        fmi2Boolean /*no_return*/) {
    return with(instance, fmi2Discard,
                [&](Component& component) { component.advance(time, length); });
}

RTAMT_FMI2_EXPORT fmi2Status fmi2CancelStep(fmi2Component instance) {
    return refuse(instance, never_pending);
}

RTAMT_FMI2_EXPORT fmi2Status fmi2GetStatus(fmi2Component /*instance*/, fmi2StatusKind /*kind*/,
                                           fmi2Status* /*value*/) {
    return fmi2Discard;
}

RTAMT_FMI2_EXPORT fmi2Status fmi2GetRealStatus(fmi2Component instance, fmi2StatusKind kind,
                                               fmi2Real* value) {
    if (kind != fmi2LastSuccessfulTime) return fmi2Discard;
    return with(instance, fmi2Error, [&](Component& component) { *value = component.reached(); });
}

RTAMT_FMI2_EXPORT fmi2Status fmi2GetIntegerStatus(fmi2Component /*instance*/,
                                                  fmi2StatusKind /*kind*/, fmi2Integer* /*value*/) {
    return fmi2Discard;
}

RTAMT_FMI2_EXPORT fmi2Status fmi2GetBooleanStatus(fmi2Component /*instance*/, fmi2StatusKind kind,
                                                  fmi2Boolean* value) {
    if (kind != fmi2Terminated) return fmi2Discard;
    *value = 0; // a monitor never ends the simulation by itself
    return fmi2OK;
}

RTAMT_FMI2_EXPORT fmi2Status fmi2GetStringStatus(fmi2Component instance, fmi2StatusKind /*kind*/,
                                                 fmi2String* /*value*/) {
    return refuse(instance, never_pending);
}

// ---- unsupported features -----------------------------------------------------------------------

RTAMT_FMI2_EXPORT fmi2Status fmi2GetDirectionalDerivative(fmi2Component instance,
                                                          const fmi2ValueReference[], std::size_t,
                                                          const fmi2ValueReference[], std::size_t,
                                                          const fmi2Real[], fmi2Real[]) {
    return refuse(instance, no_derivatives);
}

RTAMT_FMI2_EXPORT fmi2Status fmi2SetRealInputDerivatives(fmi2Component instance,
                                                         const fmi2ValueReference[], std::size_t,
                                                         const fmi2Integer[], const fmi2Real[]) {
    return refuse(instance, no_derivatives);
}

RTAMT_FMI2_EXPORT fmi2Status fmi2GetRealOutputDerivatives(fmi2Component instance,
                                                          const fmi2ValueReference[], std::size_t,
                                                          const fmi2Integer[], fmi2Real[]) {
    return refuse(instance, no_derivatives);
}
