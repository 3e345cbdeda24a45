// Tiles traced in float and double. Compiled once for each instruction set; see isa.h.

#include "tracing/kernel.h"

#include "tracing/real_kernel.h"

namespace whitted::WHITTED_ISA {

Kernel* make_kernel(const SceneDescription& scene, const RenderSettings& settings, const SearchPlan& plan) {
    if (settings.precision == Precision::single) {
        return new RealKernel<float>(scene, settings, plan);
    }
    return new RealKernel<double>(scene, settings, plan);
}

}  // namespace whitted::WHITTED_ISA
