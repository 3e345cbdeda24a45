// Tiles and pixels traced in float, double and long double. Compiled once for each instruction set; see isa.h.

#include "kernel.h"

#include <array>
#include <cstddef>

#include "camera.h"
#include "trace.h"

namespace whitted::WHITTED_ISA {

// The rays of a rectangle of pixels: row by row, in each a grid of grid x grid rays a pixel, one place of it after the
// other.
template <typename Real>
class PrimaryRays {
 public:
    PrimaryRays(const Camera<Real>& camera, const EyeContact<Real>& contact, const RenderSettings& settings,
                const Tile& tile)
        : camera_(camera),
          contact_(contact),
          tile_(tile),
          grid_(settings.grid),
          shift_(settings.corner ? Real(0.5) : Real(0)),
          reach_(max_norm(Vector<Lanes<Real>>(camera.eye()))),
          column_(tile.left),
          row_(tile.top) {}

    bool done() const { return row_ == tile_.bottom; }
    bool begins_row() const { return column_ == tile_.left && sample_ == 0; }

    // The next rays of the row, as many as there are lanes and pixels left.
    Group<Real> next() {
        using L = Lanes<Real>;
        const L columns = L(static_cast<Real>(column_)) + L::numbers();
        const L rows = static_cast<Real>(row_);
        Group<Real> group;
        group.rays.origin = Vector<L>(camera_.eye());
        group.rays.direction =
            camera_.directions(columns + L(offset(sample_ % grid_)), rows + L(offset(sample_ / grid_)));
        group.rays.t_min = camera_.eye_error();
        group.rays.object = contact_.object;
        group.rays.patch = contact_.patch;
        group.rays.inside = contact_.leads_inside(group.rays.direction, camera_.eye_error(), camera_.spread());
        group.rays.spread = camera_.spread();
        group.rays.reach = reach_;
        group.weight = Real(1);
        group.depth = 0;
        group.pixel = Indices<Real>((row_ - tile_.top) * (tile_.right - tile_.left) + column_ - tile_.left) +
                      Indices<Real>::numbers();
        group.record = -1;
        group.active = Mask<Real>::first(tile_.right - column_);
        advance();
        return group;
    }

 private:
    void advance() {
        column_ += lane_count<Real>;
        if (column_ < tile_.right) {
            return;
        }
        column_ = tile_.left;
        if (++sample_ == grid_ * grid_) {
            sample_ = 0;
            ++row_;
        }
    }

    // Of a place in the grid from its pixel's top-left corner, across or down.
    Real offset(int place) const { return (static_cast<Real>(place) + Real(0.5)) / static_cast<Real>(grid_) - shift_; }

    const Camera<Real>& camera_;
    const EyeContact<Real>& contact_;
    const Tile tile_;
    const int grid_;
    const Real shift_;
    const Lanes<Real> reach_;  // of the eye
    int column_, row_;
    int sample_ = 0;  // a place in the grid
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
                store(sums[pixel++], grid2, picture + 3 * index);
            }
        }
        return true;
    }

    void trace_pixel(int column, int row, float* color, RayTree& tree) const override {
        Recorder recorder(tree);
        Tracer<Real, Recorder> tracer(scene_, settings_, recorder);
        Color<typename Tracer<Real, Recorder>::Sum> sum{0, 0, 0};
        const PrimaryRays<Real> rays(camera_, scene_.eye_contact, settings_, {column, row, column + 1, row + 1});
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
