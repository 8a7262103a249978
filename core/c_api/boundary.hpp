// The boundary of the C API: checks of the caller's memory, and exceptions. No exception leaves it;
// each failure becomes a status and a message.
#pragma once

#include "rtamt.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <exception>
#include <new>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

namespace rtamt::c_api {

inline constexpr const char* out_of_memory = "There is not enough memory.";
inline constexpr const char* no_place = "The place for the result is null: pass an address.";

// Calls `work` and returns its status; `say` receives the message of a failure.
template <class Work, class Say>
[[nodiscard]] rtamt_status guarded(Work&& work, Say&& say) noexcept {
    try {
        std::forward<Work>(work)();
        return RTAMT_OK;
    } catch (const std::bad_alloc&) {
        say(out_of_memory);
        return RTAMT_NO_MEMORY;
    } catch (const std::length_error&) { // of a container
        say(out_of_memory);
        return RTAMT_NO_MEMORY;
    } catch (const std::exception& exception) {
        say(exception.what());
        return RTAMT_REFUSED;
    }
}

// Memory of the caller's that is to hold so many items.
template <class Item>
[[nodiscard]] std::span<Item> items(Item* memory, std::size_t count, const char* what) {
    if (memory == nullptr && count != 0) {
        throw std::invalid_argument(std::string(what) + " are null: pass the address of " +
                                    std::to_string(count) + ", or the number 0.");
    }
    return {memory, count};
}

template <class Item>
void put(Item* place, Item item) noexcept {
    if (place != nullptr) *place = item;
}

[[nodiscard]] inline std::span<const std::uint8_t> bytes(const void* memory,
                                                         std::size_t size) noexcept {
    return {static_cast<const std::uint8_t*>(memory), memory == nullptr ? 0 : size};
}

inline void copy_message(const char* sentence, char* message, std::size_t room) noexcept {
    if (message == nullptr || room == 0) return;
    const std::size_t length = std::min(std::strlen(sentence), room - 1);
    std::memcpy(message, sentence, length);
    message[length] = '\0';
}

// Copies a state to where the caller asked for it, or reports its size alone.
template <class Size, class Write>
void save(void* state, std::size_t room, std::size_t* size, Size&& size_of, Write&& write) {
    if (size == nullptr) throw std::invalid_argument(no_place);
    *size = size_of();
    if (state == nullptr) return;
    if (room < *size) {
        throw std::invalid_argument("The state takes " + std::to_string(*size) +
                                    " bytes, and there is room for " + std::to_string(room) +
                                    ": make room for all of them.");
    }
    write(std::span(static_cast<std::uint8_t*>(state), *size));
}

} // namespace rtamt::c_api
