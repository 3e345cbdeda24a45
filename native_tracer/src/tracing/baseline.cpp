// What newer instructions make no faster, compiled for all processors only: long double, which no register holds twice,
// and single pixels with their trees of rays.

#include "tracing/kernel.h"
#include "tracing/real_kernel.h"
#include "tracing/recorder.h"

namespace whitted::baseline {

Kernel* make_extended_kernel(const SceneDescription& scene, const RenderSettings& settings, const SearchPlan& plan) {
    return new RealKernel<long double>(scene, settings, plan);
}

namespace {

template <typename Real>
void record(const SceneDescription& description, const RenderSettings& settings, const SearchPlan& plan,
            const Tile& pixel, float* color, RayTree& tree) {
    const Scene<Real> scene(description, plan);
    const Camera<Real> camera(description.camera, settings.width, settings.height);
    Recorder recorder(tree);
    Tracer<Real, Recorder> tracer(scene, settings, recorder);
    Color<typename Tracer<Real, Recorder>::Sum> sum{0, 0, 0};
    RayCounts counts;
    tracer.trace(PrimaryRays<Real>(camera, scene.eye_contact, settings, pixel), &sum, counts, std::atomic<bool>(false));
    store_mean(sum, settings.grid * settings.grid, color);
}

}  // namespace

void record_pixel(const SceneDescription& scene, const RenderSettings& settings, const SearchPlan& plan, int column,
                  int row, float* color, RayTree& tree) {
    const Tile pixel{column, row, column + 1, row + 1};
    switch (settings.precision) {
        case Precision::single:
            return record<float>(scene, settings, plan, pixel, color, tree);
        case Precision::double_:
            return record<double>(scene, settings, plan, pixel, color, tree);
        case Precision::extended:
            return record<long double>(scene, settings, plan, pixel, color, tree);
    }
}

}  // namespace whitted::baseline
