// A csg that is made of fewer primitives than it is described by.

#pragma once

#include "tracing/description.h"

namespace whitted {

// The same body: an intersection of convex polyhedra is one, and so is one that half-spaces are cut off; a csg of one
// leaf is that leaf. Leaves that the program does not use are left out.
ShapeDescription simplified(const CsgDescription& csg);

}  // namespace whitted
