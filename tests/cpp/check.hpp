// A test program in fifty lines: TEST defines a test, CHECK counts and reports, main runs them all.
#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <iostream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace check {

struct Report {
    std::vector<std::pair<std::string_view, void (*)()>> tests;
    std::atomic<std::size_t> checks = 0; // by threads, too
    std::atomic<std::size_t> failures = 0;
};

inline Report& report() {
    static Report report;
    return report;
}

inline bool add(std::string_view name, void (*test)()) {
    report().tests.emplace_back(name, test);
    return true;
}

inline void expect(bool holds, std::string_view what, std::string_view file, int line) {
    ++report().checks;
    if (holds) return;
    ++report().failures;
    std::cerr << file << ':' << line << ": " << what << '\n';
}

// The message of the exception of this type that the call throws, or what happened instead.
template <class Exception, class Call>
std::string message(Call&& call) {
    try {
        std::forward<Call>(call)();
    } catch (const Exception& exception) {
        return exception.what();
    } catch (const std::exception& exception) {
        return std::string("another exception: ") + exception.what();
    }
    return "no exception";
}

} // namespace check

#define TEST(name)                                                                                 \
    static void name();                                                                            \
    [[maybe_unused]] static const bool name##_added = check::add(#name, name);                     \
    static void name()

#define CHECK(condition) check::expect((condition), #condition, __FILE__, __LINE__)
#define CHECK_NOTE(condition, note)                                                                \
    check::expect((condition), std::string(#condition " with ") + (note), __FILE__, __LINE__)

int main() {
    for (const auto& [name, test] : check::report().tests) {
        const std::size_t before = check::report().failures;
        test();
        if (check::report().failures != before) std::cerr << "in test " << name << '\n';
    }
    const check::Report& report = check::report();
    std::cout << report.tests.size() << " tests, " << report.checks << " checks, "
              << report.failures << " failures\n";
    return report.failures == 0 && report.checks != 0 ? 0 : 1;
}
