// The box around an intersection of half-spaces, with a proof that it is one.

#pragma once

#include <optional>
#include <span>

#include "bvh.h"
#include "description.h"

namespace whitted {

struct PolyhedronBox {
    Box box;
    double
        growth;    // moving all planes outward by some distance moves no side of the box by more than `growth` times it
    double reach;  // of the planes that prove the box, the largest distance from the origin
};

// The box around a polyhedron, not much larger than it has to be; nothing if the polyhedron has no bounds or no points.
// It counts as unbounded if it goes on for 2^24 times as far from the origin as its planes are.
std::optional<PolyhedronBox> box_of(std::span<const Quadruple> planes);

}  // namespace whitted
