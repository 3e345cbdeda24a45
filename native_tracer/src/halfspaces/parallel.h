// Work that falls into independent parts.

#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace whitted {

// Calls work(i) for all i below count, from as many threads as there are cores, but from no more than one for each
// `share` of them. What work throws first is thrown here, once all threads have ended.
template <typename Work>
void for_each_index(std::size_t count, std::size_t share, Work work) {
    const std::size_t thread_count =
        std::clamp<std::size_t>(count / share, 1, std::max(1U, std::thread::hardware_concurrency()));
    std::atomic<std::size_t> next = 0;
    std::exception_ptr failure;
    std::once_flag failed;
    const auto loop = [&] {
        try {
            for (std::size_t i = next++; i < count; i = next++) {
                work(i);
            }
        } catch (...) {
            next = count;
            std::call_once(failed, [&] { failure = std::current_exception(); });
        }
    };
    std::vector<std::thread> threads;
    try {
        for (std::size_t i = 1; i < thread_count; ++i) {
            threads.emplace_back(loop);
        }
    } catch (const std::system_error&) {
        // Fewer will do.
    }
    loop();
    for (std::thread& thread : threads) {
        thread.join();
    }
    if (failure) {
        std::rethrow_exception(failure);
    }
}

}  // namespace whitted
