// The functions of FMI 3.0 that a unit must have and a monitor has no use for.

#include "fmi3.hpp"
#include "instance3.hpp"

#include <cstddef>

using rtamt::fmi::Log3;
using rtamt::fmi::refuse;

namespace {

fmi3Instance no_instance(fmi3InstanceEnvironment environment,
                         fmi3LogMessageCallback callback) noexcept {
    Log3{environment, callback}.say(fmi3Error, "This unit is for co-simulation.");
    return nullptr;
}

constexpr const char* wrong_type = "This unit has no variables of this type.";
constexpr const char* no_derivatives = "This unit gives no derivatives.";
constexpr const char* no_events = "This unit has neither events nor clocks.";
constexpr const char* no_structure = "This unit has no structural parameters.";
constexpr const char* no_exchange = "This unit is for co-simulation, not for model exchange.";

} // namespace

RTAMT_FMI3_EXPORT fmi3Instance fmi3InstantiateModelExchange(
    fmi3String /*name*/, fmi3String /*token*/, fmi3String /*resources*/, fmi3Boolean /*visible*/,
    fmi3Boolean /*logging*/, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log) {
    return no_instance(environment, log);
}

RTAMT_FMI3_EXPORT fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String /*name*/, fmi3String /*token*/, fmi3String /*resources*/, fmi3Boolean /*visible*/,
    fmi3Boolean /*logging*/, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3ClockUpdateCallback /*update*/, fmi3LockPreemptionCallback /*lock*/,
    fmi3UnlockPreemptionCallback /*unlock*/) {
    return no_instance(environment, log);
}

// Types of which it has no variable, or none that can be set.
#define RTAMT_FMI3_NO_GET(Name)                                                                    \
    RTAMT_FMI3_EXPORT fmi3Status fmi3Get##Name(fmi3Instance instance, const fmi3ValueReference[],  \
                                               std::size_t count, fmi3##Name[], std::size_t) {     \
        return count == 0 ? fmi3OK : refuse(instance, wrong_type);                                 \
    }
#define RTAMT_FMI3_NO_SET(Name)                                                                    \
    RTAMT_FMI3_EXPORT fmi3Status fmi3Set##Name(fmi3Instance instance, const fmi3ValueReference[],  \
                                               std::size_t count, const fmi3##Name[],              \
                                               std::size_t) {                                      \
        return count == 0 ? fmi3OK : refuse(instance, wrong_type);                                 \
    }
RTAMT_FMI3_NO_GET(Float32)
RTAMT_FMI3_NO_GET(Int8)
RTAMT_FMI3_NO_GET(UInt8)
RTAMT_FMI3_NO_GET(Int16)
RTAMT_FMI3_NO_GET(UInt16)
RTAMT_FMI3_NO_GET(UInt32)
RTAMT_FMI3_NO_GET(UInt64)
RTAMT_FMI3_NO_GET(String)
RTAMT_FMI3_NO_SET(Float32)
RTAMT_FMI3_NO_SET(Int8)
RTAMT_FMI3_NO_SET(UInt8)
RTAMT_FMI3_NO_SET(Int16)
RTAMT_FMI3_NO_SET(UInt16)
RTAMT_FMI3_NO_SET(UInt32)
RTAMT_FMI3_NO_SET(UInt64)
RTAMT_FMI3_NO_SET(String)
#undef RTAMT_FMI3_NO_GET
#undef RTAMT_FMI3_NO_SET

RTAMT_FMI3_EXPORT fmi3Status fmi3GetBinary(fmi3Instance instance, const fmi3ValueReference[],
                                           std::size_t, std::size_t[], fmi3Binary[], std::size_t) {
    return refuse(instance, wrong_type);
}

RTAMT_FMI3_EXPORT fmi3Status fmi3SetBinary(fmi3Instance instance, const fmi3ValueReference[],
                                           std::size_t, const std::size_t[], const fmi3Binary[],
                                           std::size_t) {
    return refuse(instance, wrong_type);
}

RTAMT_FMI3_EXPORT fmi3Status fmi3GetClock(fmi3Instance instance, const fmi3ValueReference[],
                                          std::size_t, fmi3Clock[]) {
    return refuse(instance, no_events);
}

RTAMT_FMI3_EXPORT fmi3Status fmi3SetClock(fmi3Instance instance, const fmi3ValueReference[],
                                          std::size_t, const fmi3Clock[]) {
    return refuse(instance, no_events);
}

RTAMT_FMI3_EXPORT fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance /*instance*/,
                                                                 fmi3ValueReference /*reference*/,
                                                                 std::size_t* count) {
    *count = 0; // no output depends on an input directly
    return fmi3OK;
}

RTAMT_FMI3_EXPORT fmi3Status fmi3GetVariableDependencies(fmi3Instance /*instance*/,
                                                         fmi3ValueReference, std::size_t[],
                                                         fmi3ValueReference[], std::size_t[],
                                                         fmi3DependencyKind[], std::size_t) {
    return fmi3OK;
}

RTAMT_FMI3_EXPORT fmi3Status fmi3GetDirectionalDerivative(fmi3Instance instance,
                                                          const fmi3ValueReference[], std::size_t,
                                                          const fmi3ValueReference[], std::size_t,
                                                          const fmi3Float64[], std::size_t,
                                                          fmi3Float64[], std::size_t) {
    return refuse(instance, no_derivatives);
}

RTAMT_FMI3_EXPORT fmi3Status fmi3GetAdjointDerivative(fmi3Instance instance,
                                                      const fmi3ValueReference[], std::size_t,
                                                      const fmi3ValueReference[], std::size_t,
                                                      const fmi3Float64[], std::size_t,
                                                      fmi3Float64[], std::size_t) {
    return refuse(instance, no_derivatives);
}

RTAMT_FMI3_EXPORT fmi3Status fmi3GetOutputDerivatives(fmi3Instance instance,
                                                      const fmi3ValueReference[], std::size_t,
                                                      const fmi3Int32[], fmi3Float64[],
                                                      std::size_t) {
    return refuse(instance, no_derivatives);
}

RTAMT_FMI3_EXPORT fmi3Status fmi3EnterConfigurationMode(fmi3Instance instance) {
    return refuse(instance, no_structure);
}

RTAMT_FMI3_EXPORT fmi3Status fmi3ExitConfigurationMode(fmi3Instance instance) {
    return refuse(instance, no_structure);
}

RTAMT_FMI3_EXPORT fmi3Status fmi3EnterEventMode(fmi3Instance instance) {
    return refuse(instance, no_events);
}

RTAMT_FMI3_EXPORT fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance instance) {
    return refuse(instance, no_events);
}

RTAMT_FMI3_EXPORT fmi3Status fmi3UpdateDiscreteStates(fmi3Instance instance, fmi3Boolean*,
                                                      fmi3Boolean*, fmi3Boolean*, fmi3Boolean*,
                                                      fmi3Boolean*, fmi3Float64*) {
    return refuse(instance, no_events);
}

RTAMT_FMI3_EXPORT fmi3Status fmi3GetIntervalDecimal(fmi3Instance instance,
                                                    const fmi3ValueReference[], std::size_t,
                                                    fmi3Float64[], fmi3IntervalQualifier[]) {
    return refuse(instance, no_events);
}

RTAMT_FMI3_EXPORT fmi3Status fmi3GetIntervalFraction(fmi3Instance instance,
                                                     const fmi3ValueReference[], std::size_t,
                                                     fmi3UInt64[], fmi3UInt64[],
                                                     fmi3IntervalQualifier[]) {
    return refuse(instance, no_events);
}

RTAMT_FMI3_EXPORT fmi3Status fmi3GetShiftDecimal(fmi3Instance instance, const fmi3ValueReference[],
                                                 std::size_t, fmi3Float64[]) {
    return refuse(instance, no_events);
}

RTAMT_FMI3_EXPORT fmi3Status fmi3GetShiftFraction(fmi3Instance instance, const fmi3ValueReference[],
                                                  std::size_t, fmi3UInt64[], fmi3UInt64[]) {
    return refuse(instance, no_events);
}

RTAMT_FMI3_EXPORT fmi3Status fmi3SetIntervalDecimal(fmi3Instance instance,
                                                    const fmi3ValueReference[], std::size_t,
                                                    const fmi3Float64[]) {
    return refuse(instance, no_events);
}

RTAMT_FMI3_EXPORT fmi3Status fmi3SetIntervalFraction(fmi3Instance instance,
                                                     const fmi3ValueReference[], std::size_t,
                                                     const fmi3UInt64[], const fmi3UInt64[]) {
    return refuse(instance, no_events);
}

RTAMT_FMI3_EXPORT fmi3Status fmi3SetShiftDecimal(fmi3Instance instance, const fmi3ValueReference[],
                                                 std::size_t, const fmi3Float64[]) {
    return refuse(instance, no_events);
}

RTAMT_FMI3_EXPORT fmi3Status fmi3SetShiftFraction(fmi3Instance instance, const fmi3ValueReference[],
                                                  std::size_t, const fmi3UInt64[],
                                                  const fmi3UInt64[]) {
    return refuse(instance, no_events);
}

RTAMT_FMI3_EXPORT fmi3Status fmi3ActivateModelPartition(fmi3Instance instance, fmi3ValueReference,
                                                        fmi3Float64) {
    return refuse(instance, no_events);
}

// ---- model exchange -----------------------------------------------------------------------------

RTAMT_FMI3_EXPORT fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance instance) {
    return refuse(instance, no_exchange);
}

RTAMT_FMI3_EXPORT fmi3Status fmi3CompletedIntegratorStep(fmi3Instance instance, fmi3Boolean,
                                                         fmi3Boolean*, fmi3Boolean*) {
    return refuse(instance, no_exchange);
}

RTAMT_FMI3_EXPORT fmi3Status fmi3SetTime(fmi3Instance instance, fmi3Float64) {
    return refuse(instance, no_exchange);
}

RTAMT_FMI3_EXPORT fmi3Status fmi3SetContinuousStates(fmi3Instance instance, const fmi3Float64[],
                                                     std::size_t) {
    return refuse(instance, no_exchange);
}

RTAMT_FMI3_EXPORT fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance instance, fmi3Float64[],
                                                               std::size_t) {
    return refuse(instance, no_exchange);
}

RTAMT_FMI3_EXPORT fmi3Status fmi3GetEventIndicators(fmi3Instance instance, fmi3Float64[],
                                                    std::size_t) {
    return refuse(instance, no_exchange);
}

RTAMT_FMI3_EXPORT fmi3Status fmi3GetContinuousStates(fmi3Instance instance, fmi3Float64[],
                                                     std::size_t) {
    return refuse(instance, no_exchange);
}

RTAMT_FMI3_EXPORT fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance instance, fmi3Float64[],
                                                               std::size_t) {
    return refuse(instance, no_exchange);
}

RTAMT_FMI3_EXPORT fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance instance, std::size_t*) {
    return refuse(instance, no_exchange);
}

RTAMT_FMI3_EXPORT fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance instance, std::size_t*) {
    return refuse(instance, no_exchange);
}
