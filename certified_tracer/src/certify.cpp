#include "certify.h"

#include <atomic>
#include <cfenv>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <new>
#include <system_error>
#include <thread>

#include "tracer.h"
#include "upward.h"

namespace certified {

namespace {

constexpr int exceptions = FE_OVERFLOW | FE_INVALID | FE_DIVBYZERO;

// Levels are told with half a level, and the format's slack for halves that roundings have left a little low, added. A
// float next to a colour is off by 2^-25 at most, 8e-6 levels.
constexpr double half = 0.5 + 1e-4, stored = 1e-5;

template <typename I>
bool settle(const I& channel, std::uint8_t& low, std::uint8_t& high) {
    const auto level = [](const I& x) { return I(255) * x + I(half); };
    const I clamped = level(min(max(channel, I(0)), I(1)));
    const double least = clamped.low_double(), most = clamped.high_double();
    if (!(most - least < 1)) {
        return false;
    }
    low = static_cast<std::uint8_t>(std::max(least - stored, 0.0));
    high = static_cast<std::uint8_t>(std::min(most + stored, 255.5));
    return low == high || most - least < stored;
}

template <typename End>
std::unique_ptr<PreparedScene<End>> prepared(const Scene& scene) {
    std::feclearexcept(exceptions);
    auto result = std::make_unique<PreparedScene<End>>(scene);
    if (std::fetestexcept(exceptions) != 0) {
        throw Undecided{Reason::range};
    }
    return result;
}

template <typename End>
class Rung {
 public:
    // Throws Undecided where numbers are beyond those of a double.
    Rung(const Scene& scene, const Tree& tree, int number, bool last, bool quick)
        : prepared_(prepared<End>(scene)), tree_(tree), number_(number), last_(last) {
        if (quick) {
            try {
                doubles_ = prepared<double>(scene);
                plain_ = std::make_unique<PlainScene>(*doubles_);
            } catch (const Undecided&) {  // this rung can do without
            }
        }
    }

    // A thread's share: `next` gives the indices of pixels, as long as there are any.
    template <typename Next>
    void work(const std::vector<std::array<int, 2>>& pixels, std::vector<Pixel>& results, const Next& next) const {
        const Upward upward;
        Tracer<End> thorough(*prepared_, tree_, last_, nullptr, nullptr);
        if (!plain_) {
            for (std::size_t i = 0; next(i);) {
                results[i] = one(thorough, pixels[i]);
            }
            return;
        }
        Tracer<double> quick(*doubles_, tree_, false, plain_.get(), nullptr);
        Tracer<End> tracer(*prepared_, tree_, last_, plain_.get(), &quick);
        for (std::size_t i = 0; next(i);) {
            results[i] = one(tracer, pixels[i]);
            // Doubles may have left their range, or tell too little of a colour.
            if (wide && (results[i].reason == Reason::range || results[i].reason == Reason::byte)) {
                results[i] = one(thorough, pixels[i]);
            }
        }
    }

    [[gnu::noinline]] Pixel one(Tracer<End>& tracer, const std::array<int, 2>& pixel) const {
        Pixel result;
        result.rung = static_cast<std::uint8_t>(number_);
        std::feclearexcept(exceptions);
        try {
            const Vector<Interval<End>> color = tracer.pixel(pixel[0], pixel[1]);
            const bool settled = settle(color.x, result.low[0], result.high[0]) &&
                                 settle(color.y, result.low[1], result.high[1]) &&
                                 settle(color.z, result.low[2], result.high[2]);
            if (!settled) {
                result.reason = tracer.doubt() != Reason::none ? tracer.doubt() : Reason::byte;
            }
            result.color = {color.x.middle(), color.y.middle(), color.z.middle()};
            result.tied = tracer.tied();
        } catch (const Undecided& undecided) {
            result.reason = undecided.reason;
        }
        if (tracer.degenerate() && result.reason != Reason::none && result.reason != Reason::byte) {
            result.reason = Reason::degenerate;
        }
        if (std::fetestexcept(exceptions) != 0) {
            result.reason = Reason::range;
        }
        return result;
    }

 private:
    static constexpr bool wide = !std::is_same_v<End, double>;

    std::unique_ptr<PreparedScene<End>> prepared_;
    std::unique_ptr<PreparedScene<double>> doubles_;
    std::unique_ptr<PlainScene> plain_;
    const Tree& tree_;
    int number_;
    bool last_;
};

// Runs `work` on some threads, and `watch` on this one until they are done.
template <typename Work>
void on_threads(int threads, const Work& work, const std::function<void()>& watch, std::atomic<bool>& stop) {
    std::mutex lock;
    std::condition_variable ended;
    int running = threads;
    std::vector<std::thread> workers;
    workers.reserve(static_cast<std::size_t>(threads));
    std::exception_ptr failure;
    const auto run = [&] {
        try {
            work();
        } catch (...) {
            const std::lock_guard guard(lock);
            failure = std::current_exception();
            stop = true;
        }
        const std::lock_guard guard(lock);
        --running;
        ended.notify_one();
    };
    try {
        while (static_cast<int>(workers.size()) < threads) {
            workers.emplace_back(run);
        }
    } catch (const std::system_error&) {  // no room for its stack: fewer will do
        if (workers.empty()) {
            throw std::bad_alloc();
        }
        const std::lock_guard guard(lock);
        running -= threads - static_cast<int>(workers.size());
    }
    std::exception_ptr interruption;
    {
        std::unique_lock guard(lock);
        while (!ended.wait_for(guard, std::chrono::milliseconds(50), [&] { return running == 0; })) {
            guard.unlock();
            try {
                watch();
            } catch (...) {
                interruption = std::current_exception();
                stop = true;
            }
            guard.lock();
            if (stop) {
                ended.wait(guard, [&] { return running == 0; });
                break;
            }
        }
    }
    for (std::thread& worker : workers) {
        worker.join();
    }
    if (interruption || failure) {
        std::rethrow_exception(interruption ? interruption : failure);
    }
}

template <typename End>
std::unique_ptr<Rung<End>> make_rung(const Scene& scene, const Tree& tree, int number, bool last, bool quick) {
    const Upward upward;
    return std::make_unique<Rung<End>>(scene, tree, number, last, quick);
}

// Those of `indices` that this rung leaves undecided.
template <typename End>
std::vector<std::size_t> climb(const Scene& scene, const Tree& tree, const std::vector<std::array<int, 2>>& pixels,
                               const std::vector<std::size_t>& indices, int number, int threads, bool quick,
                               std::vector<Pixel>& results, const std::function<void(double)>& watch) {
    constexpr std::size_t share = sizeof(End) == sizeof(double) ? 64 : 4;
    const bool last = number == static_cast<int>(rung_digits.size()) - 1;
    std::unique_ptr<Rung<End>> rung;
    try {
        rung = make_rung<End>(scene, tree, number, last, quick);
    } catch (const Undecided& undecided) {
        for (const std::size_t i : indices) {
            results[i].reason = undecided.reason;
        }
        return indices;
    }
    std::atomic<std::size_t> taken = 0;
    std::atomic<bool> stop = false;
    const auto work = [&] {
        std::size_t at = 0, end = 0;
        rung->work(pixels, results, [&](std::size_t& i) {
            if (at == end) {
                at = taken.fetch_add(share);
                end = std::min(at + share, indices.size());
            }
            if (at >= indices.size() || stop) {
                return false;
            }
            i = indices[at++];
            return true;
        });
    };
    const double before = 1 - static_cast<double>(indices.size()) / static_cast<double>(pixels.size());
    const auto told = [&] {
        const double done = std::min(1.0, static_cast<double>(taken) / static_cast<double>(indices.size()));
        watch(0.99 * (before + (1 - before) * done));
    };
    on_threads(threads, work, told, stop);
    std::vector<std::size_t> left;
    for (const std::size_t i : indices) {
        if (results[i].reason != Reason::none) {
            left.push_back(i);
        }
    }
    return left;
}

}  // namespace

std::vector<Pixel> certify(const Scene& scene, const std::vector<std::array<int, 2>>& pixels, int first, int last,
                           int threads, bool quick, const std::function<void(double)>& watch) {
    std::vector<Pixel> results(pixels.size());
    std::vector<std::size_t> left(pixels.size());
    for (std::size_t i = 0; i < left.size(); ++i) {
        left[i] = i;
    }
    const Tree tree(scene);
    for (int number = first; number <= last && !left.empty(); ++number) {
        switch (number) {
            case 0:
                left = climb<double>(scene, tree, pixels, left, number, threads, quick, results, watch);
                break;
            case 1:
                left = climb<Wide<2>>(scene, tree, pixels, left, number, threads, quick, results, watch);
                break;
            case 2:
                left = climb<Wide<4>>(scene, tree, pixels, left, number, threads, quick, results, watch);
                break;
            default:
                left = climb<Wide<8>>(scene, tree, pixels, left, number, threads, quick, results, watch);
        }
    }
    return results;
}

}  // namespace certified
