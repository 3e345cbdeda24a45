// All shapes that there are, each kind in a list of its own.
//
// A shape is a class in a file of its own. Its primitives are the smooth pieces of its surface, numbered through the
// scene from a first one on. It answers
//
//     Description               what it is made of, an alternative of ShapeDescription
//     primitive_count           how many primitives one has that is so described
//     object                    the index of its object
//     piece                     what a primitive is called in the file: the plane's index, or -1 if there is only one
//     intersect                 where rays cross it; false, with nothing said about where, if none does; adds the rays
//                               that may tie to `close`, as to the primitive only if which_primitive is asked for
//     intersect_by_rules        likewise, with ties decided by the format's rules
//     primitive_met             of the primitives that tie where a ray has hit it, the first
//     surface_at                a point near a primitive moved onto it, so that its error does not grow with the
//                               distance travelled, and the normal
//     outward_at                the outward unit normal alone, near a point
//     error_at                  how far a primitive may be off near a point, where rays of that reach are compared with
//                               it, see Rays
//     for_each_contact          the primitives that a point lies on
//     pass                      if it may be a leaf of csg, the passage of rays, of which it is known where they start;
//                               returns the least distance between primitives that tie if it is small
//     Sight                     the shape as seen from one point, or from all within a distance of it, which tells rays
//                               through these that miss it: may_be_hit by rays from there; may_block rays that lead
//                               there
//
// All rays that it is asked about are at rest, see moving.h.
//
// Outside the kernels a description has its bounds, in search.cpp, and says what lies on it, in incidence.h.

#pragma once

#include <type_traits>

#include "shapes/convex_polyhedron.h"
#include "shapes/csg.h"
#include "shapes/moving.h"
#include "shapes/quadric.h"
#include "shapes/shape_lists.h"
#include "shapes/sphere.h"
#include "tracing/description.h"

namespace whitted::WHITTED_ISA {

template <typename Real>
using Shapes = ShapeLists<Real, Sphere<Real>, ConvexPolyhedron<Real>, Quadric<Real>, Csg<Real>, Moving<Real>>;

static_assert(std::is_same_v<Shapes<double>::Description, ShapeDescription>,
              "every alternative of ShapeDescription has its shape, in the same order");

// The shapes outside the tree, as seen from one point.
template <typename Real>
using View = typename Shapes<Real>::View;

}  // namespace whitted::WHITTED_ISA
