/* A plant as a unit of FMI 2.0: a tank that fills at rate 1 and leaks in proportion to its level.
 *
 * Only what a simulator calls of a unit without parameters; output 0 is the level.
 */
#include "fmi2FunctionTypes.h"

#include <stdlib.h>

typedef struct {
    double level;
} Plant;

const char* fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char* fmi2GetVersion(void) { return "2.0"; }

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                              const fmi2CallbackFunctions* callbacks, fmi2Boolean visible,
                              fmi2Boolean logging) {
    (void)name, (void)type, (void)guid, (void)resources, (void)callbacks, (void)visible, (void)logging;
    return calloc(1, sizeof(Plant));
}
void fmi2FreeInstance(fmi2Component plant) { free(plant); }

fmi2Status fmi2SetupExperiment(fmi2Component plant, fmi2Boolean defined, fmi2Real tolerance,
                               fmi2Real start, fmi2Boolean stop_defined, fmi2Real stop) {
    (void)plant, (void)defined, (void)tolerance, (void)start, (void)stop_defined, (void)stop;
    return fmi2OK;
}
fmi2Status fmi2EnterInitializationMode(fmi2Component plant) { return (void)plant, fmi2OK; }
fmi2Status fmi2ExitInitializationMode(fmi2Component plant) { return (void)plant, fmi2OK; }
fmi2Status fmi2Terminate(fmi2Component plant) { return (void)plant, fmi2OK; }

fmi2Status fmi2GetReal(fmi2Component plant, const fmi2ValueReference references[], size_t count,
                       fmi2Real values[]) {
    for (size_t i = 0; i < count; ++i) {
        if (references[i] != 0) return fmi2Error;
        values[i] = ((Plant*)plant)->level;
    }
    return fmi2OK;
}

fmi2Status fmi2DoStep(fmi2Component plant, fmi2Real time, fmi2Real length, fmi2Boolean no_return) {
    (void)time, (void)no_return;
    ((Plant*)plant)->level += length * (1.0 - 0.3 * ((Plant*)plant)->level);
    return fmi2OK;
}

/* What a unit must have, and nobody calls. */
#define UNUSED(name) fmi2Status name(void) { return fmi2Error; }
UNUSED(fmi2SetDebugLogging)
UNUSED(fmi2Reset)
UNUSED(fmi2GetInteger)
UNUSED(fmi2GetBoolean)
UNUSED(fmi2GetString)
UNUSED(fmi2SetReal)
UNUSED(fmi2SetInteger)
UNUSED(fmi2SetBoolean)
UNUSED(fmi2SetString)
UNUSED(fmi2GetFMUstate)
UNUSED(fmi2SetFMUstate)
UNUSED(fmi2FreeFMUstate)
UNUSED(fmi2SerializedFMUstateSize)
UNUSED(fmi2SerializeFMUstate)
UNUSED(fmi2DeSerializeFMUstate)
UNUSED(fmi2GetDirectionalDerivative)
UNUSED(fmi2SetRealInputDerivatives)
UNUSED(fmi2GetRealOutputDerivatives)
UNUSED(fmi2CancelStep)
UNUSED(fmi2GetStatus)
UNUSED(fmi2GetRealStatus)
UNUSED(fmi2GetIntegerStatus)
UNUSED(fmi2GetBooleanStatus)
UNUSED(fmi2GetStringStatus)
