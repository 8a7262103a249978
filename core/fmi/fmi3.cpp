// FMI 3.0 for co-simulation over Component. A rejected step returns fmi3Discard:
// the unit is as it was, and the simulator may try another step.

#include "fmi3.hpp"

#include "component.hpp"
#include "error_boundary.hpp"
#include "instance3.hpp"

#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <vector>

using rtamt::fmi::Component;
using rtamt::fmi::error_boundary;
using rtamt::fmi::Instance3;
using rtamt::fmi::Log3;
using rtamt::fmi::Outcome;
using rtamt::fmi::refuse;

namespace {

using State = std::vector<std::uint8_t>;

// Does the work on the component; `refusal` is the status if the component rejects it.
template <class Work>
fmi3Status with(fmi3Instance handle, fmi3Status refusal, Work&& work) noexcept {
    if (handle == nullptr) return fmi3Error;
    auto& instance = *static_cast<Instance3*>(handle);
    fmi3Status status = fmi3OK;
    (void)error_boundary(
        &instance.component, [&] { work(instance.component); },
        [&](Outcome outcome, const char* sentence) {
            status = outcome == Outcome::refused ? refusal : fmi3Error;
            instance.log.say(status, sentence);
        });
    return status;
}

constexpr const char* wrong_count = "There must be a value for each value reference.";

void require(bool equal) {
    if (!equal) throw std::invalid_argument(wrong_count);
}

// Sets inputs and parameters of any type.
template <class Value>
fmi3Status set(fmi3Instance instance, const fmi3ValueReference references[], std::size_t count,
               const Value values[], std::size_t room) noexcept {
    return with(instance, fmi3Discard, [&](Component& component) {
        require(count == room);
        std::vector<double> numbers(count);
        for (std::size_t i = 0; i < count; ++i)
            numbers[i] = static_cast<double>(values[i]);
        component.set({references, count}, numbers);
    });
}

} // namespace

// ---- lifecycle ----------------------------------------------------------------------------------

RTAMT_FMI3_EXPORT const char* fmi3GetVersion() {
    return "3.0";
}

RTAMT_FMI3_EXPORT fmi3Status fmi3SetDebugLogging(fmi3Instance /*instance*/, fmi3Boolean /*on*/,
                                                 std::size_t /*count*/,
                                                 const fmi3String /*categories*/[]) {
    return fmi3OK; // logging cannot be switched off: there are only rejections and errors
}

RTAMT_FMI3_EXPORT fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String /*name*/, fmi3String token, fmi3String resources, fmi3Boolean /*visible*/,
    fmi3Boolean /*logging*/, fmi3Boolean /*event_mode*/, fmi3Boolean /*early_return*/,
    const fmi3ValueReference /*intermediate*/[], std::size_t /*count*/,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3IntermediateUpdateCallback /*update*/) {
    Instance3* instance = nullptr;
    (void)error_boundary(
        nullptr,
        [&] {
            if (token == nullptr || resources == nullptr) {
                throw std::invalid_argument("The unit needs its token and its resources.");
            }
            Component component(resources, token);
            instance = new Instance3{{environment, log}, std::move(component)};
        },
        [&](Outcome, const char* sentence) { Log3{environment, log}.say(fmi3Error, sentence); });
    return instance;
}

RTAMT_FMI3_EXPORT void fmi3FreeInstance(fmi3Instance instance) {
    delete static_cast<Instance3*>(instance);
}

RTAMT_FMI3_EXPORT fmi3Status fmi3EnterInitializationMode(
    fmi3Instance instance, fmi3Boolean /*tolerance_defined*/, fmi3Float64 /*tolerance*/,
    fmi3Float64 start, fmi3Boolean /*stop_defined*/, fmi3Float64 /*stop*/) {
    return with(instance, fmi3Error, [&](Component& component) {
        component.begin(start);
        component.initialise();
    });
}

RTAMT_FMI3_EXPORT fmi3Status fmi3ExitInitializationMode(fmi3Instance instance) {
    return with(instance, fmi3Error, [](Component& component) { component.settle(); });
}

RTAMT_FMI3_EXPORT fmi3Status fmi3Terminate(fmi3Instance instance) {
    return with(instance, fmi3Error, [](Component& component) { component.terminate(); });
}

RTAMT_FMI3_EXPORT fmi3Status fmi3Reset(fmi3Instance instance) {
    return with(instance, fmi3Error, [](Component& component) { component.reset(); });
}

// ---- variables ----------------------------------------------------------------------------------

RTAMT_FMI3_EXPORT fmi3Status fmi3GetFloat64(fmi3Instance instance,
                                            const fmi3ValueReference references[],
                                            std::size_t count, fmi3Float64 values[],
                                            std::size_t room) {
    return with(instance, fmi3Error, [&](Component& component) {
        require(count == room);
        for (std::size_t i = 0; i < count; ++i)
            values[i] = component.real(references[i]);
    });
}

RTAMT_FMI3_EXPORT fmi3Status fmi3GetInt32(fmi3Instance instance,
                                          const fmi3ValueReference references[], std::size_t count,
                                          fmi3Int32 values[], std::size_t room) {
    return with(instance, fmi3Error, [&](Component& component) {
        require(count == room);
        for (std::size_t i = 0; i < count; ++i)
            values[i] = component.integer32(references[i]);
    });
}

// Of enumerations.
RTAMT_FMI3_EXPORT fmi3Status fmi3GetInt64(fmi3Instance instance,
                                          const fmi3ValueReference references[], std::size_t count,
                                          fmi3Int64 values[], std::size_t room) {
    return with(instance, fmi3Error, [&](Component& component) {
        require(count == room);
        for (std::size_t i = 0; i < count; ++i)
            values[i] = component.integer(references[i]);
    });
}

RTAMT_FMI3_EXPORT fmi3Status fmi3GetBoolean(fmi3Instance instance,
                                            const fmi3ValueReference references[],
                                            std::size_t count, fmi3Boolean values[],
                                            std::size_t room) {
    return with(instance, fmi3Error, [&](Component& component) {
        require(count == room);
        for (std::size_t i = 0; i < count; ++i)
            values[i] = component.boolean(references[i]);
    });
}

RTAMT_FMI3_EXPORT fmi3Status fmi3SetFloat64(fmi3Instance instance,
                                            const fmi3ValueReference references[],
                                            std::size_t count, const fmi3Float64 values[],
                                            std::size_t room) {
    return set(instance, references, count, values, room);
}

RTAMT_FMI3_EXPORT fmi3Status fmi3SetInt32(fmi3Instance instance,
                                          const fmi3ValueReference references[], std::size_t count,
                                          const fmi3Int32 values[], std::size_t room) {
    return set(instance, references, count, values, room);
}

RTAMT_FMI3_EXPORT fmi3Status fmi3SetInt64(fmi3Instance instance,
                                          const fmi3ValueReference references[], std::size_t count,
                                          const fmi3Int64 values[], std::size_t room) {
    return set(instance, references, count, values, room);
}

RTAMT_FMI3_EXPORT fmi3Status fmi3SetBoolean(fmi3Instance instance,
                                            const fmi3ValueReference references[],
                                            std::size_t count, const fmi3Boolean values[],
                                            std::size_t room) {
    return set(instance, references, count, values, room);
}

// ---- state --------------------------------------------------------------------------------------

RTAMT_FMI3_EXPORT fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState* state) {
    return with(instance, fmi3Error, [&](Component& component) {
        auto saved = std::make_unique<State>(component.save());
        if (*state == nullptr) {
            *state = saved.release();
        } else {
            *static_cast<State*>(*state) = std::move(*saved);
        }
    });
}

RTAMT_FMI3_EXPORT fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState state) {
    return with(instance, fmi3Error, [&](Component& component) {
        component.restore(*static_cast<const State*>(state));
    });
}

RTAMT_FMI3_EXPORT fmi3Status fmi3FreeFMUState(fmi3Instance /*instance*/, fmi3FMUState* state) {
    if (state == nullptr) return fmi3OK;
    delete static_cast<State*>(*state);
    *state = nullptr;
    return fmi3OK;
}

RTAMT_FMI3_EXPORT fmi3Status fmi3SerializedFMUStateSize(fmi3Instance /*instance*/,
                                                        fmi3FMUState state, std::size_t* size) {
    *size = static_cast<const State*>(state)->size();
    return fmi3OK;
}

RTAMT_FMI3_EXPORT fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState state,
                                                   fmi3Byte bytes[], std::size_t size) {
    const State& saved = *static_cast<const State*>(state);
    if (size < saved.size()) return refuse(instance, "The state needs more bytes than there are.");
    std::memcpy(bytes, saved.data(), saved.size());
    return fmi3OK;
}

RTAMT_FMI3_EXPORT fmi3Status fmi3DeserializeFMUState(fmi3Instance instance, const fmi3Byte bytes[],
                                                     std::size_t size, fmi3FMUState* state) {
    return with(instance, fmi3Error, [&](Component&) {
        const std::span<const fmi3Byte> read(bytes, size);
        *state = new State(read.begin(), read.end()); // looked at when it is set
    });
}

// ---- steps --------------------------------------------------------------------------------------

RTAMT_FMI3_EXPORT fmi3Status fmi3EnterStepMode(fmi3Instance instance) {
    return with(instance, fmi3Error, [](Component&) {});
}

RTAMT_FMI3_EXPORT fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 time, fmi3Float64 length,
                                        fmi3Boolean /*no_state_before*/, fmi3Boolean* event,
                                        fmi3Boolean* terminate, fmi3Boolean* early,
                                        fmi3Float64* reached) {
    *event = *terminate = *early = false;
    return with(instance, fmi3Discard, [&](Component& component) {
        *reached = component.reached();
        component.advance(time, length);
        *reached = component.reached();
    });
}
