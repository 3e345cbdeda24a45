// Pictures whose bytes are proven, from doubles to ever wider numbers.

#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "scene.h"
#include "undecided.h"

namespace certified {

// What is known of a pixel. Its bytes are `low`, or `high`, which is the same or, where a colour lies so near the edge
// between two levels that storing it as a float may take it over, the next. `color` lies in what encloses the true one,
// before that is clamped.
struct Pixel {
    std::array<std::uint8_t, 3> low{}, high{};
    std::array<double, 3> color{};
    Reason reason = Reason::none;
    std::uint8_t rung = 0;
    bool tied = false;  // the rule for ties decided something
};

inline constexpr std::array<int, 4> rung_digits = {53, 128, 256, 512};

// The pixels (column, row) on the rungs first to last; `quick`: with what spares intervals, or digits. `watch(done)` is
// called now and then from the calling thread, and may throw to stop it.
std::vector<Pixel> certify(const Scene& scene, const std::vector<std::array<int, 2>>& pixels, int first, int last,
                           int threads, bool quick, const std::function<void(double)>& watch);

}  // namespace certified
