// A monitor of the C API that destroys itself, and its state as bytes.
#pragma once

#include "c_api/rtamt.h"

#include "check.hpp"
#include "forged.hpp"
#include "programs.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace c_api {

using Bytes = std::vector<std::uint8_t>;

struct Destroy {
    void operator()(rtamt_monitor* monitor) const { rtamt_destroy(monitor); }
};
using Handle = std::unique_ptr<rtamt_monitor, Destroy>;

inline Handle create(const programs::Program& program) {
    const Bytes bytes = programs::bytes_of(program);
    rtamt_monitor* monitor = nullptr;
    CHECK(rtamt_create(bytes.data(), bytes.size(), &monitor, nullptr, 0) == RTAMT_OK);
    return Handle(monitor);
}

inline Handle clone(const Handle& monitor) {
    rtamt_monitor* copied = nullptr;
    CHECK(rtamt_clone(monitor.get(), &copied) == RTAMT_OK);
    return Handle(copied);
}

inline Bytes save(const Handle& monitor) {
    std::size_t size = 0;
    CHECK(rtamt_save(monitor.get(), nullptr, 0, &size) == RTAMT_OK);
    Bytes state(size);
    CHECK(rtamt_save(monitor.get(), state.data(), size, &size) == RTAMT_OK);
    return state;
}

inline rtamt_status restore(const Handle& monitor, const Bytes& state) {
    return rtamt_restore(monitor.get(), state.data(), state.size());
}

// States of a program with other numbers in them and a right checksum: each is refused, and changes
// nothing then, or the monitor goes on without harm. `advance(monitor, cut)` brings a monitor to
// each of the cuts, at 12 to the end of its trace; `go_on(monitor, cut)` gives it samples after it.
template <class Advance, class GoOn>
void check_forged(const programs::Program& program, const std::vector<int>& cuts, Advance&& advance,
                  GoOn&& go_on) {
    std::size_t refused = 0;
    std::size_t taken = 0;
    for (const int cut : cuts) {
        const Handle monitor = create(program);
        advance(monitor, cut);
        if (cut == 12) CHECK(rtamt_finish(monitor.get()) == RTAMT_OK);
        const Handle victim = create(program);
        forged::each(save(monitor), [&](const Bytes& state) {
            const Bytes before = save(victim);
            if (restore(victim, state) != RTAMT_OK) {
                ++refused;
                CHECK(save(victim) == before);
                return;
            }
            ++taken;
            go_on(victim, cut);
            const Bytes later = save(victim);
            CHECK(restore(victim, later) == RTAMT_OK);
            (void)rtamt_finish(victim.get());
            std::int64_t until = 0;
            (void)rtamt_known_until(victim.get(), 0, &until);
        });
    }
    // Numbers that only change values are as good as others.
    CHECK((refused > 1000 && taken > 1000));
}

} // namespace c_api
