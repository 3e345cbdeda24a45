// A picture drawn by several threads.

#pragma once

#include <cstdlib>
#include <functional>
#include <memory>

#include "tracing/kernel.h"

namespace whitted {

// Pixels as linear RGB, row 0 on top; black until they are drawn.
class Image {
 public:
    // Throws std::invalid_argument for a size that is not positive, std::bad_alloc for one too large.
    Image(int width, int height);

    int width() const { return width_; }
    int height() const { return height_; }
    float* data() { return pixels_.get(); }

    RayCounts counts;  // of the last rendering into it
    int threads = 0;
    bool by_tree = false;  // its objects were searched by a tree

 private:
    struct Free {
        void operator()(float* pixels) const { std::free(pixels); }
    };

    int width_, height_;
    std::unique_ptr<float[], Free> pixels_;
};

// Draws the picture with `threads` threads, 0: one for each core. `watch` is called from the calling thread about 20
// times a second with the share that is done; what it throws stops the rendering at once and is thrown on, and the
// tiles that are finished stay in the image. The bytes do not depend on the number of threads.
void render(const Kernel& kernel, Image& image, int threads, const std::function<void(double)>& watch);

}  // namespace whitted
