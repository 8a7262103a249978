// The interface of custom operators in C++: include this header, write a class, name it
// with RTAMT_KERNEL, build a shared library, and give its path to the operator's record
// (docs/how-to/extend.md). Nothing of the core has to be linked.
//
//     class Average {
//       public:
//         explicit Average(const rtamt_setup& setup);
//         void run(const rtamt_samples& samples); // discrete time
//     };
//     RTAMT_KERNEL(average, Average)
//
// The class is made anew for every trace; it may throw, and what it throws becomes the message of
// an error. It is copyable: its copy is the checkpoint to which a failed update goes back. A class
// whose state is large has checkpoint() and rollback() of its own instead. In dense time run()
// takes an rtamt_stretch.
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <new>
#include <string>
#include <type_traits>
#include <utility>

// The version of the tables that this header describes.
inline constexpr std::uint32_t rtamt_kernel_version = 1;

extern "C" {

// What a kernel is made for. Steps are samples in discrete time and ticks in dense time.
struct rtamt_setup {
    std::int64_t begin; // the interval, in steps
    std::int64_t end;   // -1 where there is no upper bound, or no interval
    double step;        // seconds
    std::size_t operands;
};

// A block of samples. With h the number of samples that the operator reads ahead, the result at a
// sample is due when the operands have come h samples further, or have ended.
struct rtamt_samples {
    const double* const* operands; // `count` new values of each
    std::size_t count;
    bool last;   // no more will come; there may be further blocks with results that are due
    double* out; // room for the next `due` results
    std::size_t due;
};

// Changes of a step function: from each time on the value beside it holds.
struct rtamt_events {
    const std::int64_t* times;
    const double* values;
    std::size_t count;
};

// A stretch of dense time: the operands' changes after the last stretch and up to `until`, that
// instant included. The first change of every operand is at `start`, where the trace begins. The
// result's changes after those emitted so far and up to `due`, the first at `start`, go to emit(),
// in the order of time. Until `due` reaches `start`, nothing is due.
struct rtamt_stretch {
    const rtamt_events* operands;
    std::int64_t start;
    std::int64_t until;
    std::int64_t due;
    void (*emit)(void* sink, std::int64_t time, double value);
    void* sink;
};

// A table of functions: all that the core knows of a kernel. `run` or `advance` is null, for dense
// or discrete time. They return null, or what went wrong, valid until the next call.
struct rtamt_kernel {
    std::uint32_t version; // rtamt_kernel_version
    void* context;
    // The state of one instruction; null, and the reason in `error`, where there can be none.
    void* (*create)(void* context, const rtamt_setup* setup, const char** error);
    void (*destroy)(void* state);
    void (*reset)(void* state);
    void (*checkpoint)(void* state);
    void (*rollback)(void* state);
    const char* (*run)(void* state, const rtamt_samples* samples);
    const char* (*advance)(void* state, const rtamt_stretch* stretch);
};

} // extern "C"

namespace rtamt {

// The table of a class, see above.
template <class Class>
class KernelOf {
    static constexpr bool discrete =
        requires(Class& kernel, const rtamt_samples& samples) { kernel.run(samples); };
    static constexpr bool dense =
        requires(Class& kernel, const rtamt_stretch& stretch) { kernel.run(stretch); };
    static constexpr bool own_checkpoint = requires(Class& kernel) {
        kernel.checkpoint();
        kernel.rollback();
    };
    static_assert(discrete || dense, "run() takes const rtamt_samples& or const rtamt_stretch&");
    static_assert(own_checkpoint || std::is_copy_constructible_v<Class>,
                  "a kernel is copyable, or has checkpoint() and rollback()");

    struct State {
        rtamt_setup setup{};
        std::unique_ptr<Class> now;
        std::unique_ptr<Class> saved;
        bool kept = false; // `saved` is the checkpoint
        std::string error; // what went wrong since the checkpoint
    };

    // Calls `work`; returns null, or what it threw.
    template <class Work>
    static const char* guarded(State& state, Work&& work) noexcept {
        try {
            state.error.clear();
            std::forward<Work>(work)();
            return nullptr;
        } catch (const std::exception& exception) {
            return describe(state, exception.what());
        } catch (...) {
            return describe(state, "an exception that is no std::exception");
        }
    }

    static const char* describe(State& state, const char* what) noexcept {
        try {
            state.error = what;
            if (state.error.empty()) state.error = "an exception without a message";
        } catch (const std::bad_alloc&) {
            return "out of memory";
        }
        return state.error.c_str();
    }

    static State& of(void* state) noexcept { return *static_cast<State*>(state); }

    static void* create(void* /*context*/, const rtamt_setup* setup, const char** error) noexcept {
        static thread_local State failed; // keeps the message
        auto* state = new (std::nothrow) State;
        if (state == nullptr) {
            *error = "out of memory";
            return nullptr;
        }
        state->setup = *setup;
        if (guarded(*state, [&] { state->now = std::make_unique<Class>(*setup); }) != nullptr) {
            *error = describe(failed, state->error.c_str());
            destroy(state);
            return nullptr;
        }
        return state;
    }

    static void destroy(void* state) noexcept { delete static_cast<State*>(state); }

    // A failure here leaves no kernel; the next run() reports it.
    static void reset(void* state) noexcept {
        State& kernel = of(state);
        kernel.now.reset();
        kernel.kept = false;
        (void)guarded(kernel, [&] { kernel.now = std::make_unique<Class>(kernel.setup); });
    }

    static void checkpoint(void* state) noexcept {
        State& kernel = of(state);
        if (!kernel.now) return;
        (void)guarded(kernel, [&] {
            kernel.kept = false;
            if constexpr (own_checkpoint) {
                kernel.now->checkpoint();
            } else if constexpr (std::is_copy_assignable_v<Class>) {
                if (kernel.saved) {
                    *kernel.saved = *kernel.now;
                } else {
                    kernel.saved = std::make_unique<Class>(*kernel.now);
                }
            } else {
                kernel.saved = std::make_unique<Class>(*kernel.now);
            }
            kernel.kept = true;
        });
    }

    static void rollback(void* state) noexcept {
        State& kernel = of(state);
        kernel.error.clear();
        if (!kernel.kept) return; // then nothing has run since
        kernel.kept = false;
        if constexpr (own_checkpoint) {
            (void)guarded(kernel, [&] { kernel.now->rollback(); });
        } else {
            std::swap(kernel.now, kernel.saved);
        }
    }

    template <class Block>
    static const char* call(void* state, const Block* block) noexcept {
        State& kernel = of(state);
        if (!kernel.now || !kernel.error.empty()) return kernel.error.c_str();
        return guarded(kernel, [&] { kernel.now->run(*block); });
    }

  public:
    static rtamt_kernel table() noexcept {
        rtamt_kernel kernel{rtamt_kernel_version, nullptr,  create,  destroy, reset,
                            checkpoint,           rollback, nullptr, nullptr};
        if constexpr (discrete) kernel.run = call<rtamt_samples>;
        if constexpr (dense) kernel.advance = call<rtamt_stretch>;
        return kernel;
    }
};

} // namespace rtamt

#ifdef _WIN32
#define RTAMT_EXPORT extern "C" __declspec(dllexport)
#else
#define RTAMT_EXPORT extern "C" __attribute__((visibility("default")))
#endif

// Names a class: the operator's record gives the name of the library and this one.
#define RTAMT_KERNEL(name, Class)                                                                  \
    RTAMT_EXPORT const rtamt_kernel* name() {                                                      \
        static const rtamt_kernel table = rtamt::KernelOf<Class>::table();                         \
        return &table;                                                                             \
    }
