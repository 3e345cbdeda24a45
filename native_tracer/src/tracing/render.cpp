#include "tracing/render.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <limits>
#include <mutex>
#include <new>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <vector>

namespace whitted {

Image::Image(int width, int height) : width_(width), height_(height) {
    if (width <= 0 || height <= 0) {
        throw std::invalid_argument("an image needs a width and a height above 0");
    }
    const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    if (pixels > std::numeric_limits<std::size_t>::max() / (3 * sizeof(float))) {
        throw std::bad_alloc();
    }
    // Fresh pages are zero already; the threads that draw are the first to touch them.
    pixels_.reset(static_cast<float*>(std::calloc(pixels, 3 * sizeof(float))));
    if (!pixels_) {
        throw std::bad_alloc();
    }
}

namespace {

// Tiles are dealt to whichever thread is free, one at a time.
class Drawing {
 public:
    Drawing(const Kernel& kernel, Image& image) : kernel_(kernel), image_(image) {
        const auto tiles_in = [](int pixels, int size) { return pixels / size + (pixels % size != 0 ? 1 : 0); };
        columns_ = static_cast<std::size_t>(tiles_in(image.width(), tile_width));
        tiles_ = columns_ * static_cast<std::size_t>(tiles_in(image.height(), tile_height));
    }

    void run(int threads, const std::function<void(double)>& watch) {
        const int most = static_cast<int>(std::min<std::size_t>(tiles_, 4096));
        if (threads <= 0) {
            threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
        }
        image_.counts = {};
        image_.threads = std::min(threads, most);
        image_.by_tree = kernel_.uses_tree();
        std::vector<std::thread> workers;
        try {
            for (int i = 0; i < image_.threads; ++i) {
                {
                    const std::lock_guard lock(mutex_);
                    ++working_;
                }
                try {
                    workers.emplace_back([this] { work(); });
                } catch (const std::system_error&) {  // no room for its stack: fewer will do
                    const std::lock_guard lock(mutex_);
                    --working_;
                    break;
                }
            }
            if (workers.empty()) {
                throw std::bad_alloc();
            }
            image_.threads = static_cast<int>(workers.size());
            wait(watch);
        } catch (...) {
            stop_ = true;
            join(workers);
            throw;
        }
        join(workers);
        if (failure_) {
            std::rethrow_exception(failure_);
        }
        watch(1);
    }

 private:
    void work() {
        RayCounts counts;
        try {
            for (std::size_t i = next_++; i < tiles_ && !stop_; i = next_++) {
                if (kernel_.trace_tile(tile(i), image_.data(), counts, stop_)) {
                    ++done_;
                }
            }
        } catch (...) {
            stop_ = true;
            const std::lock_guard lock(mutex_);
            failure_ = std::current_exception();
        }
        const std::lock_guard lock(mutex_);
        image_.counts.primary += counts.primary;
        image_.counts.reflected += counts.reflected;
        image_.counts.transmitted += counts.transmitted;
        image_.counts.shadow += counts.shadow;
        image_.counts.pixels_too_deep += counts.pixels_too_deep;
        image_.counts.deepest = std::max(image_.counts.deepest, counts.deepest);
        if (--working_ == 0) {
            finished_.notify_all();
        }
    }

    void wait(const std::function<void(double)>& watch) {
        std::unique_lock lock(mutex_);
        while (!finished_.wait_for(lock, std::chrono::milliseconds(50), [this] { return working_ == 0; })) {
            lock.unlock();
            watch(static_cast<double>(done_) / static_cast<double>(tiles_));
            lock.lock();
        }
    }

    static void join(std::vector<std::thread>& workers) {
        for (std::thread& worker : workers) {
            worker.join();
        }
    }

    Tile tile(std::size_t i) const {
        const int left = static_cast<int>(i % columns_) * tile_width;
        const int top = static_cast<int>(i / columns_) * tile_height;
        return {left, top, left + std::min(tile_width, image_.width() - left),
                top + std::min(tile_height, image_.height() - top)};
    }

    const Kernel& kernel_;
    Image& image_;
    std::size_t columns_, tiles_;
    std::atomic<std::size_t> next_{0}, done_{0};
    std::atomic<bool> stop_{false};

    std::mutex mutex_;  // guards what follows, and the image's counts
    std::condition_variable finished_;
    int working_ = 0;
    std::exception_ptr failure_;
};

}  // namespace

void render(const Kernel& kernel, Image& image, int threads, const std::function<void(double)>& watch) {
    Drawing(kernel, image).run(threads, watch);
}

}  // namespace whitted
