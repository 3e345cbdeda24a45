// A picture drawn by several threads.

#pragma once

#include <cstdint>
#include <cstdlib>
#include <functional>
#include <memory>
#include <vector>

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

// The sums of the samples of whole passes over a picture: what drawing may go on from.
class PassSums {
 public:
    // Throws as Image does.
    PassSums(int width, int height);

    int width() const { return width_; }
    int height() const { return height_; }
    double* colors() { return current_.get(); }            // height x width x 3
    unsigned char* too_deep() { return too_deep_.get(); }  // height x width

    // Puts the mean of the samples into an image of the same size.
    void show(Image& image, int samples) const;

    int passes = 0;    // that are whole
    RayCounts counts;  // of theirs

 private:
    friend void render(const Kernel&, Image&, PassSums&, const std::vector<Places>&, const unsigned char*, int,
                       const std::function<void(double)>&);

    struct Free {
        void operator()(void* numbers) const { std::free(numbers); }
    };

    int width_, height_;
    // A pass reads one and fills the other, so that a pass that is stopped changes nothing.
    std::unique_ptr<double[], Free> current_, next_;
    std::unique_ptr<unsigned char[], Free> too_deep_;
};

// Draws the picture with `threads` threads, 0: one for each core. `watch` is called from the calling thread about 20
// times a second with the share that is done; what it throws stops the rendering at once and is thrown on, and the
// tiles that are finished stay in the image. The bytes do not depend on the number of threads.
void render(const Kernel& kernel, Image& image, int threads, const std::function<void(double)>& watch);

// The same, and the pixels' signatures, height x width, of rays that weigh at least so much; see signer.h.
void render_signed(const Kernel& kernel, Image& image, std::uint32_t* signatures, double least_weight, int threads,
                   const std::function<void(double)>& watch);

// The same, pass after pass over the whole picture, each with some places of every pixel. Those that are in `sums` are
// not drawn again. The picture has the mean of what is drawn of it at every moment; if drawing is stopped, the sums
// have the passes that are whole. With a mask, height x width, pixels where it is 0 stay what they are.
void render(const Kernel& kernel, Image& image, PassSums& sums, const std::vector<Places>& passes,
            const unsigned char* mask, int threads, const std::function<void(double)>& watch);

}  // namespace whitted
