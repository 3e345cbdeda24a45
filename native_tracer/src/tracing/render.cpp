#include "tracing/render.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <mutex>
#include <new>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

namespace whitted {

namespace {

// Zeros, `count` for each pixel. Fresh pages are zero already; the threads that draw are the first to touch them.
template <typename Number>
Number* zeros(int width, int height, std::size_t count) {
    if (width <= 0 || height <= 0) {
        throw std::invalid_argument("an image needs a width and a height above 0");
    }
    const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    if (pixels > std::numeric_limits<std::size_t>::max() / (count * sizeof(Number))) {
        throw std::bad_alloc();
    }
    void* numbers = std::calloc(pixels, count * sizeof(Number));
    if (numbers == nullptr) {
        throw std::bad_alloc();
    }
    return static_cast<Number*>(numbers);
}

}  // namespace

Image::Image(int width, int height) : width_(width), height_(height), pixels_(zeros<float>(width, height, 3)) {}

PassSums::PassSums(int width, int height)
    : width_(width),
      height_(height),
      current_(zeros<double>(width, height, 3)),
      next_(zeros<double>(width, height, 3)),
      too_deep_(zeros<unsigned char>(width, height, 1)) {}

void PassSums::show(Image& image, int samples) const {
    const std::size_t numbers = 3 * static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
    for (std::size_t i = 0; i < numbers; ++i) {
        image.data()[i] = static_cast<float>(current_[i] / samples);
    }
}

namespace {

void add(RayCounts& sum, const RayCounts& counts) {
    sum.primary += counts.primary;
    sum.reflected += counts.reflected;
    sum.transmitted += counts.transmitted;
    sum.shadow += counts.shadow;
    sum.pixels_too_deep += counts.pixels_too_deep;
    sum.deepest = std::max(sum.deepest, counts.deepest);
}

// Tiles are dealt to whichever thread is free, one at a time.
class Drawing {
 public:
    // Draws a tile, or returns false if it was stopped.
    using DrawTile = std::function<bool(const Tile&, RayCounts&, const std::atomic<bool>&)>;

    Drawing(Image& image, DrawTile draw_tile) : image_(image), draw_tile_(std::move(draw_tile)) {
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
    }

 private:
    void work() {
        RayCounts counts;
        try {
            for (std::size_t i = next_++; i < tiles_ && !stop_; i = next_++) {
                if (draw_tile_(tile(i), counts, stop_)) {
                    ++done_;
                }
            }
        } catch (...) {
            stop_ = true;
            const std::lock_guard lock(mutex_);
            failure_ = std::current_exception();
        }
        const std::lock_guard lock(mutex_);
        add(image_.counts, counts);
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

    Image& image_;
    const DrawTile draw_tile_;
    std::size_t columns_, tiles_;
    std::atomic<std::size_t> next_{0}, done_{0};
    std::atomic<bool> stop_{false};

    std::mutex mutex_;  // guards what follows, and the image's counts
    std::condition_variable finished_;
    int working_ = 0;
    std::exception_ptr failure_;
};

void draw(const Kernel& kernel, Image& image, int threads, const std::function<void(double)>& watch,
          const Drawing::DrawTile& draw_tile) {
    image.by_tree = kernel.uses_tree();
    Drawing(image, draw_tile).run(threads, watch);
    watch(1);
}

}  // namespace

void render(const Kernel& kernel, Image& image, int threads, const std::function<void(double)>& watch) {
    draw(kernel, image, threads, watch, [&](const Tile& tile, RayCounts& counts, const std::atomic<bool>& stop) {
        return kernel.trace_tile(tile, image.data(), counts, stop);
    });
}

void render_signed(const Kernel& kernel, Image& image, std::uint32_t* signatures, double least_weight, int threads,
                   const std::function<void(double)>& watch) {
    draw(kernel, image, threads, watch, [&](const Tile& tile, RayCounts& counts, const std::atomic<bool>& stop) {
        return kernel.sign_tile(tile, image.data(), signatures, least_weight, counts, stop);
    });
}

void render(const Kernel& kernel, Image& image, PassSums& sums, const std::vector<Places>& passes,
            const unsigned char* mask, int threads, const std::function<void(double)>& watch) {
    if (image.width() != sums.width() || image.height() != sums.height()) {
        throw std::invalid_argument("an image and its sums have the same size");
    }
    const std::size_t pixels = static_cast<std::size_t>(sums.width()) * static_cast<std::size_t>(sums.height());
    const auto last = static_cast<int>(passes.size());
    int samples = 0;
    for (int pass = 0; pass < std::min(sums.passes, last); ++pass) {
        samples += static_cast<int>(passes[static_cast<std::size_t>(pass)].size());
    }
    if (samples > 0 && mask == nullptr) {
        sums.show(image, samples);
    }
    image.by_tree = kernel.uses_tree();
    while (sums.passes < last) {
        const Places& places = passes[static_cast<std::size_t>(sums.passes)];
        samples += static_cast<int>(places.size());
        const SampleSums tiles{sums.current_.get(), sums.next_.get(), sums.too_deep(), samples};
        const auto draw_tile = [&](const Tile& tile, RayCounts& counts, const std::atomic<bool>& stop) {
            return kernel.add_samples(tile, places, mask, tiles, image.data(), counts, stop);
        };
        Drawing(image, draw_tile).run(threads, [&](double share) { watch((sums.passes + share) / last); });
        add(sums.counts, image.counts);
        std::swap(sums.current_, sums.next_);
        ++sums.passes;
        watch(static_cast<double>(sums.passes) / last);
    }
    image.counts = sums.counts;
    image.counts.pixels_too_deep = static_cast<std::uint64_t>(
        std::count(sums.too_deep(), sums.too_deep() + pixels, static_cast<unsigned char>(1)));
}

}  // namespace whitted
