// Where rays cross a shape, and how far that may be off.
//
// A ray never hits what it starts on by a rounding error. What it starts on is known - object, primitive, and whether
// the ray travels inside that object - and a line meets a primitive at most twice: of a convex one, a ray that leaves
// it outward cannot meet it again, and one that travels inside meets only its far side; of another, the place where the
// ray starts is taken out of the equation. A ray bound for another object has to travel farther than t_min, a bound of
// its origin's rounding error, so that two surfaces that touch do not shade each other at random. Nothing is compared
// with an absolute constant: a scene in millimetres is drawn as the same scene in kilometres.
//
// Waechter and Binder, "A Fast and Robust Method for Avoiding Self-Intersection", Ray Tracing Gems, 2019, ch. 6.
// Pharr, Jakob and Humphreys, "Physically Based Rendering", 4th ed., 2023, section 6.8.

#pragma once

#include <cmath>
#include <limits>

#include "tracing/ray.h"
#include "tracing/rounding.h"
#include "tracing/vector.h"

namespace whitted::WHITTED_ISA {

// The up to two places where lines meet a primitive or a convex shape, near and far, and what they meet there: they are
// in it between them, or outside it where it is `inverted`. Where there is none it is infinite. Of rays whose start on
// the shape is known, `far` is the other end. Lines that miss it are nowhere in it, or wholly where it is inverted.
template <typename Real>
struct Passage {
    Lanes<Real> near = -std::numeric_limits<Real>::infinity();
    Lanes<Real> far = std::numeric_limits<Real>::infinity();
    Indices<Real> near_primitive = -1;
    Indices<Real> far_primitive = -1;
    Mask<Real> misses;
    Mask<Real> inverted = Mask<Real>::none();
};

// Where rays cross one object.
template <typename Real>
struct Crossing {
    Lanes<Real> t;  // infinite: nowhere
    Indices<Real> primitive;
    Mask<Real> inside;  // the surface is met from within
};

// Which of the two counts for rays that have the given passage through a shape; those `from_within` start on it, and
// only the other end is ahead.
template <typename Real>
[[gnu::always_inline]] inline Crossing<Real> first_crossing(const Passage<Real>& passage, const Rays<Real>& rays,
                                                            Mask<Real> from_within) {
    using L = Lanes<Real>;
    const L infinity = std::numeric_limits<Real>::infinity();
    const Mask<Real> enters = (passage.near > rays.t_min) & ~from_within;
    const L far =
        select(from_within, max(passage.far, L(Real(0))), select(passage.far > rays.t_min, passage.far, infinity));
    return {select(passage.misses, infinity, select(enters, passage.near, far)),
            select(enters, passage.near_primitive, passage.far_primitive), ~enters};
}

// Points moved onto a primitive.
template <typename Real>
struct SurfacePoint {
    Vector<Lanes<Real>> point;
    Vector<Lanes<Real>> outward;  // the unit normals there
    Lanes<Real> error;            // how far the primitive may be off
    Lanes<Real> curvature;        // by how much the normal turns along a unit of length, at most
};

// How far a ray and a surface may be off from one another at distance t, where the surface itself may be off by
// `error`.
template <typename Real>
Real blur(const Rays<Real>& rays, int lane, Real error, Real t) {
    return rays.t_min[lane] + error + std::abs(t) * rays.spread[lane];
}

// How far a ray's distance to a primitive of the shape may be off.
template <typename Shape, typename Real>
Real distance_error(const Shape& shape, const Rays<Real>& rays, int lane, int primitive, Real t) {
    const Vector<Real> direction = lane_of(rays.direction, lane);
    const Vector<Real> point = lane_of(rays.origin, lane) + t * direction;
    const Real error = shape.error_at(primitive, rays.reach[lane], point);
    return blur(rays, lane, error, t) / std::abs(dot(shape.outward_at(primitive, point), direction));
}

// The same, as far as ties go by it.
template <typename Shape, typename Real>
Real tie_error(const Shape& shape, const Rays<Real>& rays, int lane, int primitive, Real t) {
    const Real error = distance_error(shape, rays, lane, primitive, t);
    const Real most = most_blur<Real> * (t + rays.reach[lane]);
    return error <= most ? error : most;  // it is NaN where the point is rounded to a sphere's centre
}

}  // namespace whitted::WHITTED_ISA
