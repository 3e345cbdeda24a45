// The kernel of one precision.

#pragma once

#include <array>
#include <atomic>
#include <cstddef>

#include "tracing/camera.h"
#include "tracing/kernel.h"
#include "tracing/observer.h"
#include "tracing/primary_rays.h"
#include "tracing/scene.h"
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
        Tracer<Real, Unobserved> tracer(scene_, settings_, unobserved);
        using Sum = typename Tracer<Real, Unobserved>::Sum;
        std::array<Color<Sum>, tile_width * tile_height> sums;
        sums.fill({0, 0, 0});
        if (!tracer.trace(PrimaryRays<Real>(camera_, scene_.eye_contact, settings_, tile), sums.data(), counts, stop)) {
            return false;
        }
        const int grid2 = settings_.grid * settings_.grid;
        std::size_t pixel = 0;
        for (int row = tile.top; row < tile.bottom; ++row) {
            for (int column = tile.left; column < tile.right; ++column) {
                const std::size_t index = static_cast<std::size_t>(row) * static_cast<std::size_t>(settings_.width) +
                                          static_cast<std::size_t>(column);
                store_mean(sums[pixel++], grid2, picture + 3 * index);
            }
        }
        return true;
    }

    bool uses_tree() const override { return !scene_.tree.empty(); }

 private:
    const Scene<Real> scene_;
    const Camera<Real> camera_;
    const RenderSettings settings_;
};

}  // namespace whitted::WHITTED_ISA
