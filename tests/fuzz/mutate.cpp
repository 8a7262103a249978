// Runs a fuzz target over changed files of its corpus, without any library: the same ones for the
// same seed. What it does where no libFuzzer is, and as a test.
//
//     mutate_TARGET COUNT SEED DIRECTORY...
//
// Each input depends on the seed and its number alone, so that `mutate_TARGET 1 SEED+NUMBER` runs
// the one that failed again. An input that takes more than ten seconds of the processor has failed.
#include "changes.hpp"

#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <new>
#include <random>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

constexpr itimerval longest{{0, 0}, {10, 0}};              // seconds
constexpr std::size_t most_memory = std::size_t{1} << 24U; // in one piece

std::uint64_t number = 0; // of the input that runs

// Calls what is safe in a handler alone.
void tell(int signal) {
    std::array<char, 64> text{};
    const int length = std::snprintf(text.data(), text.size(), "input %llu, signal %d\n",
                                     static_cast<unsigned long long>(number), signal);
    (void)!write(STDERR_FILENO, text.data(), static_cast<std::size_t>(length));
    _exit(1);
}

[[nodiscard]] std::vector<changes::Bytes> read(const std::vector<std::string>& directories) {
    std::vector<std::filesystem::path> paths;
    for (const std::string& directory : directories) {
        for (const auto& entry : std::filesystem::directory_iterator(directory))
            paths.push_back(entry.path());
    }
    std::ranges::sort(paths);
    std::vector<changes::Bytes> files;
    for (const auto& path : paths) {
        std::ifstream file(path, std::ios::binary);
        const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
        files.emplace_back(bytes.begin(), bytes.end());
    }
    return files;
}

} // namespace

// No memory is no error of the sanitizers.
extern "C" const char* __asan_default_options() { // NOLINT(bugprone-reserved-identifier): its name
    return "allocator_may_return_null=1:max_allocation_size_mb=1024";
}
void* operator new(std::size_t size) {
    if (size > most_memory) throw std::bad_alloc();
    const std::size_t room = std::max<std::size_t>(size, 1);
    void* memory = std::malloc(room); // NOLINT(cppcoreguidelines-no-malloc): made of it
    if (memory == nullptr) throw std::bad_alloc();
    return memory;
}
void operator delete(void* memory) noexcept {
    std::free(memory); // NOLINT(cppcoreguidelines-no-malloc): made of it
}
void operator delete(void* memory, std::size_t /*size*/) noexcept {
    operator delete(memory);
}

int main(int count, char** arguments) { // NOLINT(misc-const-correctness): as C++ has it
    const std::vector<std::string> given(arguments + 1, arguments + count);
    if (given.size() < 2) return 2;
    const std::uint64_t inputs = std::stoull(given[0]);
    const std::uint64_t seed = std::stoull(given[1]);
    const auto files = read({given.begin() + 2, given.end()});
    for (const int signal : {SIGPROF, SIGABRT})
        (void)std::signal(signal, tell);
    for (number = seed; number < seed + inputs; ++number) {
        std::mt19937_64 random(number);
        changes::Bytes chosen(64);
        for (std::uint8_t& byte : chosen)
            byte = static_cast<std::uint8_t>(random());
        changes::Choices choices(chosen.data(), chosen.size());
        changes::Bytes input = chosen; // without files the choices themselves
        if (!files.empty()) {
            input = files[choices.below(files.size())];
            change(input, files[choices.below(files.size())], choices);
        }
        (void)setitimer(ITIMER_PROF, &longest, nullptr);
        (void)LLVMFuzzerTestOneInput(input.data(), input.size());
    }
    std::cout << inputs << " inputs\n";
    return 0;
}
