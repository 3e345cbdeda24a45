// Whether a point lies on a surface: the eye on a floor, a lamp on a ceiling.
//
// The distance between such a point and such a surface is 0, but computed along a ray it is a rounding error of either
// sign, another one for every ray. So it is settled once, before rays are traced, what lies on what.

#pragma once

#include <vector>

#include "tracing/description.h"

namespace whitted {

// Whether the point lies on the surface for some numbers that round to these doubles, as the decimal numbers of a file
// do: each may be wrong by 2^-53 of itself.
bool lies_on(const SphereDescription& sphere, const Triple& point);
bool lies_on(const Quadruple& plane, const Triple& point);
bool lies_on(const QuadricDescription& quadric, const Triple& point);

// Whether a primitive of a shape, see shapes.h, moved by a displacement lies in itself, as far as decimals can say:
// then what lies on it does so while it moves.
bool slides(const SphereDescription& sphere, int piece, const Triple& displacement);
bool slides(const PolyhedronDescription& polyhedron, int piece, const Triple& displacement);
bool slides(const QuadricDescription& quadric, int piece, const Triple& displacement);
bool slides(const CsgDescription& csg, int piece, const Triple& displacement);

// Whether the point lies in the half-spaces of all planes, or on their borders.
bool lies_within(const std::vector<Quadruple>& planes, const Triple& point);

}  // namespace whitted
