// The kernel of one precision.

#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "tracing/camera.h"
#include "tracing/kernel.h"
#include "tracing/observer.h"
#include "tracing/primary_rays.h"
#include "tracing/scene.h"
#include "tracing/signer.h"
#include "tracing/trace.h"
#include "tracing/vector.h"

namespace whitted::WHITTED_ISA {

// The mean of `count` colours, of which this is the sum.
template <typename Sum>
void store_mean(const Color<Sum>& sum, int count, float* pixel) {
    const Color<Sum> mean = sum / static_cast<Sum>(count);
    pixel[0] = static_cast<float>(mean.x);
    pixel[1] = static_cast<float>(mean.y);
    pixel[2] = static_cast<float>(mean.z);
}

template <typename Real>
class RealKernel final : public Kernel {
 public:
    RealKernel(const SceneDescription& scene, const RenderSettings& settings, const SearchPlan& plan)
        : scene_(scene, plan), camera_(scene.camera, settings.width, settings.height), settings_(settings) {}

    bool trace_tile(const Tile& tile, float* picture, RayCounts& counts, const std::atomic<bool>& stop) const override {
        Unobserved unobserved;
        return trace_pixels(unobserved, tile, all_rays(tile), counts, stop,
                            [&](const Pixel& pixel) { show(pixel, picture); });
    }

    bool sign_tile(const Tile& tile, float* picture, std::uint32_t* signatures, double least_weight, RayCounts& counts,
                   const std::atomic<bool>& stop) const override {
        std::array<std::uint32_t, tile_width * tile_height> words{};
        Signer<Real> signer(words.data(), least_weight);
        return trace_pixels(signer, tile, all_rays(tile), counts, stop, [&](const Pixel& pixel) {
            show(pixel, picture);
            signatures[pixel.index] = words[pixel.in_tile];
        });
    }

    bool add_samples(const Tile& tile, const Places& places, const unsigned char* mask, const SampleSums& sums,
                     float* picture, RayCounts& counts, const std::atomic<bool>& stop) const override {
        Unobserved unobserved;
        const PrimaryRays<Real> rays(camera_, scene_.eye_contact, settings_, tile, &places, mask);
        return trace_pixels(unobserved, tile, rays, counts, stop, [&](const Pixel& pixel) {
            const double* before = sums.before + 3 * pixel.index;
            double* after = sums.after + 3 * pixel.index;
            after[0] = before[0] + static_cast<double>(pixel.sum.x);
            after[1] = before[1] + static_cast<double>(pixel.sum.y);
            after[2] = before[2] + static_cast<double>(pixel.sum.z);
            if (mask != nullptr && mask[pixel.index] == 0) {
                return;
            }
            store_mean(Color<double>{after[0], after[1], after[2]}, sums.samples, picture + 3 * pixel.index);
            if (pixel.too_deep) {
                sums.too_deep[pixel.index] = 1;
            }
        });
    }

    bool uses_tree() const override { return !scene_.tree.empty(); }

 private:
    using Sum = typename Tracer<Real, Unobserved>::Sum;

    // What is known of a pixel when its samples are traced.
    struct Pixel {
        std::size_t index, in_tile;  // in the picture, and in the tile
        const Color<Sum>& sum;
        bool too_deep;
    };

    PrimaryRays<Real> all_rays(const Tile& tile) const { return {camera_, scene_.eye_contact, settings_, tile}; }

    void show(const Pixel& pixel, float* picture) const {
        store_mean(pixel.sum, settings_.grid * settings_.grid, picture + 3 * pixel.index);
    }

    // Calls store(pixel) for each pixel of the tile, once the rays are traced.
    template <typename Observer, typename Store>
    bool trace_pixels(Observer& observer, const Tile& tile, const PrimaryRays<Real>& rays, RayCounts& counts,
                      const std::atomic<bool>& stop, Store store) const {
        Tracer<Real, Observer> tracer(scene_, settings_, observer);
        std::array<Color<Sum>, tile_width * tile_height> sums;
        sums.fill({0, 0, 0});
        if (!tracer.trace(rays, sums.data(), counts, stop)) {
            return false;
        }
        std::size_t pixel = 0;
        for (int row = tile.top; row < tile.bottom; ++row) {
            for (int column = tile.left; column < tile.right; ++column, ++pixel) {
                const std::size_t index =
                    static_cast<std::size_t>(row) * static_cast<std::size_t>(settings_.part.width) +
                    static_cast<std::size_t>(column);
                store(Pixel{index, pixel, sums[pixel], tracer.too_deep(pixel)});
            }
        }
        return true;
    }

    const Scene<Real> scene_;
    const Camera<Real> camera_;
    const RenderSettings settings_;
};

}  // namespace whitted::WHITTED_ISA
