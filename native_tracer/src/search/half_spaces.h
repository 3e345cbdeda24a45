// What half-spaces have in common, and how far it goes.

#pragma once

#include <array>
#include <optional>
#include <span>

#include "search/bounds.h"
#include "tracing/description.h"

namespace whitted {

// The points where normal.x <= height; the normal is a unit vector. Where it follows from other surfaces, moving those
// outward by some distance moves it by no more than `growth` times that.
struct HalfSpace {
    std::array<double, 3> normal;
    double height;
    double growth = 1;
};

HalfSpace half_space_of(const Quadruple& plane);

// Along a direction no point lies farther than `height`, which moves by `growth` times as much as surfaces do.
struct Support {
    double height, growth;
};

// Nothing if there is no such bound, or no point. The direction is a unit vector. What is rounded is no more than
// surfaces moved by some 2^-44 of the distance from the origin.
std::optional<Support> support_of(std::span<const HalfSpace> half_spaces, const std::array<double, 3>& direction);

std::optional<Bounds> bounds_of(std::span<const HalfSpace> half_spaces);

}  // namespace whitted
