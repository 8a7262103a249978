// An instance of an FMU of FMI 3.0 and its log.
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

// Logs why a call is wrong in this state and returns the error.
[[nodiscard]] inline fmi3Status refuse(fmi3Instance handle, const char* sentence) noexcept {
    if (handle != nullptr) static_cast<Instance3*>(handle)->log.say(fmi3Error, sentence);
    return fmi3Error;
}

} // namespace rtamt::fmi
