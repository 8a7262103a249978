// Shares independent pieces of work among threads.
//
// Threads last as long as the call, so that a process may fork at any other time. What one of them
// throws is thrown again when all have ended.
//
// Cost: some ten microseconds a thread.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

namespace rtamt {

// Calls work(thread, piece) for each piece once, on at most `threads` threads counted from 0, of
// which the caller is the first; on fewer where the system has no more.
template <class Work>
void share_work(std::size_t pieces, std::size_t threads, Work&& work) {
    std::atomic<std::size_t> next{0};
    std::vector<std::exception_ptr> thrown(std::clamp<std::size_t>(pieces, 1, threads));
    const auto take = [&](std::size_t thread) noexcept {
        try {
            for (std::size_t piece = next++; piece < pieces; piece = next++)
                work(thread, piece);
        } catch (...) {
            thrown[thread] = std::current_exception();
            next = pieces;
        }
    };
    std::vector<std::jthread> others;
    others.reserve(thrown.size() - 1);
    try {
        while (others.size() + 1 < thrown.size())
            others.emplace_back(take, others.size() + 1);
        // NOLINTNEXTLINE(bugprone-empty-catch): the threads that there are do the work
    } catch (const std::system_error&) {
    }
    take(0);
    others.clear(); // waits for them
    for (const std::exception_ptr& exception : thrown) {
        if (exception) std::rethrow_exception(exception);
    }
}

} // namespace rtamt
