// Tiles and pixels traced in float, double and long double. Compiled once for each instruction set; see isa.h.

#include "kernel.h"

#include <array>
#include <cstddef>

#include "camera.h"
#include "trace.h"

namespace whitted::WHITTED_ISA {

// The rays of a rectangle of pixels: row by row, in each pixel a grid of grid x grid rays.
template <typename Real>
class PrimaryRays {
 public:
    PrimaryRays(const Camera<Real>& camera, const RenderSettings& settings, const Tile& tile)
        : camera_(camera),
          tile_(tile),
          grid_(settings.grid),
          shift_(settings.corner ? Real(0.5) : Real(0)),
          column_(tile.left),
          row_(tile.top) {
        place_sample();
    }

    // The next rays, as many as there are lanes and rays left; false when there are none.
    bool next(Group<Real>& group) {
        Real columns[lane_count<Real>], rows[lane_count<Real>];
        group.count = 0;
        for (int lane = 0; lane < lane_count<Real>; ++lane) {
            columns[lane] = static_cast<Real>(column_) + sample_x_;
            rows[lane] = static_cast<Real>(row_) + sample_y_;
            group.pixel[lane] = pixel_;
            if (row_ < tile_.bottom) {
                ++group.count;
                advance();
            }
        }
        using L = Lanes<Real>;
        group.rays.origin = Vector<L>(camera_.eye());
        group.rays.direction = camera_.directions(L::gather([&](int lane) { return columns[lane]; }),
                                                  L::gather([&](int lane) { return rows[lane]; }));
        group.rays.t_min = Real(0);
        group.rays.object = group.rays.patch = -1;
        group.rays.inside = Mask<Real>::none();
        group.depth = 0;
        group.weight = Real(1);
        group.active = Mask<Real>::first(group.count);
        return group.count > 0;
    }

 private:
    void advance() {
        if (grid_ > 1) {
            sample_ = (sample_ + 1) % (grid_ * grid_);
            place_sample();
        }
        if (sample_ > 0) {
            return;
        }
        ++pixel_;
        if (++column_ == tile_.right) {
            column_ = tile_.left;
            ++row_;
        }
    }

    void place_sample() {
        sample_x_ = (static_cast<Real>(sample_ % grid_) + Real(0.5)) / static_cast<Real>(grid_) - shift_;
        sample_y_ = (static_cast<Real>(sample_ / grid_) + Real(0.5)) / static_cast<Real>(grid_) - shift_;
    }

    const Camera<Real>& camera_;
    const Tile tile_;
    const int grid_;
    const Real shift_;
    int column_, row_;
    int pixel_ = 0;  // counted within the tile
    int sample_ = 0;
    Real sample_x_, sample_y_;  // its place in its pixel
};

template <typename Real>
class RealKernel final : public Kernel {
 public:
    RealKernel(const SceneDescription& scene, const RenderSettings& settings, const SearchPlan& plan)
        : scene_(scene, plan), camera_(scene.camera, settings.width, settings.height), settings_(settings) {}

    bool trace_tile(const Tile& tile, float* picture, RayCounts& counts, const std::atomic<bool>& stop) const override {
        Unobserved unobserved;
        Tracer<Real, Unobserved> tracer(scene_, settings_, unobserved);
        using Sum = typename Tracer<Real, Unobserved>::Sum;
        std::array<Color<Sum>, tile_size * tile_size> sums;
        sums.fill({0, 0, 0});
        if (!tracer.trace(PrimaryRays<Real>(camera_, settings_, tile), sums.data(), counts, stop)) {
            return false;
        }
        const int grid2 = settings_.grid * settings_.grid;
        std::size_t pixel = 0;
        for (int row = tile.top; row < tile.bottom; ++row) {
            for (int column = tile.left; column < tile.right; ++column) {
                const std::size_t index = static_cast<std::size_t>(row) * static_cast<std::size_t>(settings_.width) +
                                          static_cast<std::size_t>(column);
                store(sums[pixel++], grid2, picture + 3 * index);
            }
        }
        return true;
    }

    void trace_pixel(int column, int row, float* color, RayTree& tree) const override {
        Recorder recorder(tree);
        Tracer<Real, Recorder> tracer(scene_, settings_, recorder);
        Color<typename Tracer<Real, Recorder>::Sum> sum{0, 0, 0};
        const PrimaryRays<Real> rays(camera_, settings_, {column, row, column + 1, row + 1});
        RayCounts counts;
        tracer.trace(rays, &sum, counts, std::atomic<bool>(false));
        store(sum, settings_.grid * settings_.grid, color);
    }

    bool uses_tree() const override { return !scene_.tree.empty(); }

 private:
    template <typename Sum>
    static void store(const Color<Sum>& sum, int count, float* pixel) {
        const Color<Sum> mean = sum / static_cast<Sum>(count);
        pixel[0] = static_cast<float>(mean.x);
        pixel[1] = static_cast<float>(mean.y);
        pixel[2] = static_cast<float>(mean.z);
    }

    const Scene<Real> scene_;
    const Camera<Real> camera_;
    const RenderSettings settings_;
};

Kernel* make_kernel(const SceneDescription& scene, const RenderSettings& settings, const SearchPlan& plan) {
    switch (settings.precision) {
        case Precision::single:
            return new RealKernel<float>(scene, settings, plan);
        case Precision::extended:
            return new RealKernel<long double>(scene, settings, plan);
        case Precision::normal:
            break;
    }
    return new RealKernel<double>(scene, settings, plan);
}

}  // namespace whitted::WHITTED_ISA
