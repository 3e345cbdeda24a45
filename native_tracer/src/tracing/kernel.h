// The tracer behind one interface, whatever the precision and the instruction set it was compiled for.

#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "search/search.h"
#include "tracing/description.h"
#include "tracing/ray_tree.h"

namespace whitted {

// A rectangle of pixels, up to but excluding `right` and `bottom`.
struct Tile {
    int left, top, right, bottom;
};

// Wide, so that registers full of neighbouring pixels fit in, and not too small, for its last rays leave lanes empty.
inline constexpr int tile_width = 64, tile_height = 32;

// Where the rays of a pixel pass: places in the grid, row by row, in the order in which they are traced.
using Places = std::vector<int>;

// The sums of a picture's samples, height x width x 3 each, and which of its pixels lack rays for the depth limit.
struct SampleSums {
    const double* before;
    double* after;
    unsigned char* too_deep;  // a byte a pixel, set to 1 where it is so
    int samples;              // of each pixel, in `after`
};

class Kernel {
 public:
    virtual ~Kernel();

    // Draws a tile into `picture`, which holds the whole picture, height x width x 3. Returns false, with the tile
    // untouched, if it was stopped. May be called from several threads at once.
    virtual bool trace_tile(const Tile& tile, float* picture, RayCounts& counts,
                            const std::atomic<bool>& stop) const = 0;

    // The same, and the pixels' signatures, height x width of the picture, of rays that weigh at least so much; see
    // signer.h.
    virtual bool sign_tile(const Tile& tile, float* picture, std::uint32_t* signatures, double least_weight,
                           RayCounts& counts, const std::atomic<bool>& stop) const = 0;

    // The same as trace_tile with some of the samples only: their sums are added to those before, and the picture has
    // the mean of all so far. With a mask, sums and colours of other pixels stay what they are.
    virtual bool add_samples(const Tile& tile, const Places& places, const unsigned char* mask, const SampleSums& sums,
                             float* picture, RayCounts& counts, const std::atomic<bool>& stop) const = 0;

    // Whether the objects are searched by a tree.
    virtual bool uses_tree() const = 0;
};

// `instructions` is "baseline", "avx2" or "avx512"; empty: the best that this processor has. Throws
// std::invalid_argument if it has not, or if the program was not compiled for it. Long double knows no other than
// "baseline", and takes that whatever is named. The kernel refers to the description's textures and must not outlive
// it.
std::unique_ptr<Kernel> make_kernel(const SceneDescription& scene, const RenderSettings& settings,
                                    std::string_view instructions = {});

// Traces one pixel, with its rays put into `tree` and its colour, as trace_tile would leave it, into `color`.
void record_pixel(const SceneDescription& scene, const RenderSettings& settings, int column, int row, float* color,
                  RayTree& tree);

// Each is kernel.cpp, compiled for one instruction set; the baseline has more, see baseline.cpp.
namespace baseline {
Kernel* make_kernel(const SceneDescription& scene, const RenderSettings& settings, const SearchPlan& plan);
Kernel* make_extended_kernel(const SceneDescription& scene, const RenderSettings& settings, const SearchPlan& plan);
void record_pixel(const SceneDescription& scene, const RenderSettings& settings, const SearchPlan& plan, int column,
                  int row, float* color, RayTree& tree);
}  // namespace baseline
namespace avx2 {
Kernel* make_kernel(const SceneDescription& scene, const RenderSettings& settings, const SearchPlan& plan);
}
namespace avx512 {
Kernel* make_kernel(const SceneDescription& scene, const RenderSettings& settings, const SearchPlan& plan);
}

}  // namespace whitted
