// What FMI 2.0 says of a co-simulation unit's types and callbacks, as far as the functions need it.
//
// Written from the standard (fmi-standard.org), which fixes names and layout; vendoring its headers
// would bring the declarations of model exchange and a second licence for these thirty lines.
#pragma once

#include <cstddef>

#if defined(_WIN32)
#define RTAMT_FMI_EXPORT extern "C" __declspec(dllexport)
#else
#define RTAMT_FMI_EXPORT extern "C" __attribute__((visibility("default")))
#endif

using fmi2Component = void*;
using fmi2ComponentEnvironment = void*;
using fmi2FMUstate = void*;
using fmi2ValueReference = unsigned int;
using fmi2Real = double;
using fmi2Integer = int;
using fmi2Boolean = int;
using fmi2Byte = char;
using fmi2String = const char*;

enum fmi2Status { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending };
enum fmi2Type { fmi2ModelExchange, fmi2CoSimulation };
enum fmi2StatusKind { fmi2DoStepStatus, fmi2PendingStatus, fmi2LastSuccessfulTime, fmi2Terminated };

struct fmi2CallbackFunctions {
    void (*logger)(fmi2ComponentEnvironment, fmi2String name, fmi2Status, fmi2String category,
                   fmi2String message, ...);
    void* (*allocateMemory)(std::size_t count, std::size_t size);
    void (*freeMemory)(void* memory);
    void (*stepFinished)(fmi2ComponentEnvironment, fmi2Status);
    fmi2ComponentEnvironment componentEnvironment;
};
