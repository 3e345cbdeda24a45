// The box around what several bodies have in common, also where none of them has bounds.

#pragma once

#include <optional>
#include <vector>

#include "search/bounds.h"
#include "search/half_spaces.h"
#include "tracing/description.h"

namespace whitted {

// Bodies, each of which holds what is bounded: primitives, half-spaces, and others by the boxes around them.
struct Common {
    std::vector<const LeafDescription*> leaves;
    std::vector<HalfSpace> half_spaces;
    std::vector<Bounds> boxes;
};

// Nothing if there are no bounds. If there is nothing in it, which a box cannot say, it may be the box around any.
std::optional<Bounds> bounds_of(const Common& common);

// The smaller box that lies in both, where both are known.
std::optional<Bounds> intersected(const std::optional<Bounds>& a, const std::optional<Bounds>& b);

}  // namespace whitted
