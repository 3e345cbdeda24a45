// Picks the copy of kernel.cpp that suits the processor.

#include <stdexcept>
#include <string>

#include "tracing/kernel.h"

namespace whitted {

namespace {

using Make = Kernel* (*)(const SceneDescription&, const RenderSettings&, const SearchPlan&);

struct Variant {
    std::string_view name;
    bool available;
    Make make;
};

SearchPlan plan_of(const SceneDescription& scene, const RenderSettings& settings) {
    return plan_search(scene, settings.search, settings.precision);
}

}  // namespace

// Here, so that no compilation for a newer processor provides them.
Kernel::~Kernel() = default;

std::unique_ptr<Kernel> make_kernel(const SceneDescription& scene, const RenderSettings& settings,
                                    std::string_view instructions) {
    // The best first.
    const Variant variants[] = {
#if defined(WHITTED_X86_VARIANTS)
        {"avx512", __builtin_cpu_supports("x86-64-v4") != 0, avx512::make_kernel},
        {"avx2", __builtin_cpu_supports("x86-64-v3") != 0, avx2::make_kernel},
#endif
        {"baseline", true, baseline::make_kernel},
    };
    for (const Variant& variant : variants) {
        if (variant.available && (instructions.empty() || instructions == variant.name)) {
            const Make make = settings.precision == Precision::extended ? baseline::make_extended_kernel : variant.make;
            return std::unique_ptr<Kernel>(make(scene, settings, plan_of(scene, settings)));
        }
    }
    throw std::invalid_argument("this processor or this build has no '" + std::string(instructions) + "' instructions");
}

void record_pixel(const SceneDescription& scene, const RenderSettings& settings, int column, int row, float* color,
                  RayTree& tree) {
    baseline::record_pixel(scene, settings, plan_of(scene, settings), column, row, color, tree);
}

}  // namespace whitted
