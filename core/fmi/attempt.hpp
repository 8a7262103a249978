// Calls that come from a simulator: no exception leaves, each failure becomes a sentence.
#pragma once

#include "component.hpp"

#include <cstdint>
#include <exception>
#include <new>
#include <stdexcept>
#include <utility>

namespace rtamt::fmi {

enum class Fate : std::uint8_t {
    done,
    refused, // everything is as it was
    failed,  // out of memory, or a mistake of ours
};

// Does the work; where that fails, `say` takes its fate and the sentence.
template <class Work, class Say>
[[nodiscard]] Fate attempt(const Component* component, Work&& work, Say&& say) noexcept {
    constexpr const char* out_of_memory = "There is not enough memory.";
    const auto tell = [&](Fate fate, const char* sentence) {
        say(fate, sentence);
        return fate;
    };
    try {
        try {
            std::forward<Work>(work)();
            return Fate::done;
        } catch (const capi::Undefined& failure) { // by a step, so there is a component
            return tell(Fate::refused, component->undefined(failure).c_str());
        }
    } catch (const std::bad_alloc&) {
        return tell(Fate::failed, out_of_memory);
    } catch (const std::length_error&) { // of a container
        return tell(Fate::failed, out_of_memory);
    } catch (const std::invalid_argument& error) {
        return tell(Fate::refused, error.what());
    } catch (const std::exception& error) {
        return tell(Fate::failed, error.what());
    }
}

} // namespace rtamt::fmi
