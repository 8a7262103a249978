// An instance of a unit of FMI 3.0, and what it says.
#pragma once

#include "component.hpp"
#include "fmi3.hpp"

namespace rtamt::fmi {

struct Log3 {
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback callback;

    void say(fmi3Status status, const char* sentence) const noexcept {
        if (callback == nullptr) return;
        callback(environment, status, status == fmi3Discard ? "logStatusDiscard" : "logStatusError",
                 sentence);
    }
};

struct Instance3 {
    Log3 log;
    Component component;
};

// Says why a call is wrong here, whatever its arguments.
[[nodiscard]] inline fmi3Status refuse(fmi3Instance handle, const char* sentence) noexcept {
    if (handle != nullptr) static_cast<Instance3*>(handle)->log.say(fmi3Error, sentence);
    return fmi3Error;
}

} // namespace rtamt::fmi
