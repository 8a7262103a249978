// Calls from a simulator: no exception leaves, each failure becomes a message.
#pragma once

#include "component.hpp"

#include <cstdint>
#include <exception>
#include <new>
#include <stdexcept>
#include <utility>

namespace rtamt::fmi {

enum class Outcome : std::uint8_t {
    done,
    refused, // everything is as it was
    failed,  // out of memory, or a mistake of ours
};

// Does the work; if that fails, `say` receives its outcome and the message.
template <class Work, class Say>
[[nodiscard]] Outcome error_boundary(const Component* component, Work&& work, Say&& say) noexcept {
    constexpr const char* out_of_memory = "There is not enough memory.";
    const auto report = [&](Outcome outcome, const char* sentence) {
        say(outcome, sentence);
        return outcome;
    };
    try {
        try {
            std::forward<Work>(work)();
            return Outcome::done;
        } catch (const c_api::Undefined& failure) { // by a step, so there is a component
            return report(Outcome::refused, component->undefined(failure).c_str());
        }
    } catch (const std::bad_alloc&) {
        return report(Outcome::failed, out_of_memory);
    } catch (const std::length_error&) { // of a container
        return report(Outcome::failed, out_of_memory);
    } catch (const std::invalid_argument& error) {
        return report(Outcome::refused, error.what());
    } catch (const std::exception& error) {
        return report(Outcome::failed, error.what());
    }
}

} // namespace rtamt::fmi
