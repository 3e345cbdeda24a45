// Spheres and convex polyhedra: where a ray crosses them, and the surface there.
//
// A ray never hits what it starts on by a rounding error. What it starts on is known - object, plane, and whether the
// ray travels inside that object - and both shapes are convex: a ray that leaves one outward cannot meet it again, and
// one that travels inside meets only its far side. A ray bound for another object has to travel farther than t_min, a
// bound of its origin's rounding error, so that two surfaces that touch do not shade each other at random. Nothing is
// compared with an absolute constant: a scene in millimetres is drawn as the same scene in kilometres.
//
// Waechter and Binder, "A Fast and Robust Method for Avoiding Self-Intersection", Ray Tracing Gems, 2019, ch. 6.
// Pharr, Jakob and Humphreys, "Physically Based Rendering", 4th ed., 2023, section 6.8.

#pragma once

#include <limits>

#include "ray.h"
#include "vector.h"

namespace whitted::WHITTED_ISA {

// Where rays cross one object.
template <typename Real>
struct Crossing {
    Lanes<Real> t;  // infinite: nowhere
    Indices<Real> patch;
    Mask<Real> inside;  // the surface is met from within
};

// A smooth piece of an object's surface: a sphere, or one plane of a polyhedron.
template <typename Real>
struct Patch {
    Vector<Real> anchor;  // the sphere's centre, or the plane's outward unit normal
    Real size;            // the sphere's radius, or the plane's offset: inside is dot(normal, p) + offset <= 0
    bool round;
};

template <typename Real>
struct Sphere {
    Vector<Real> center;
    Real radius;
    Real reach2;  // a line farther from the centre than its root misses, whatever was rounded
    int object, patch;

    Sphere(const Vector<Real>& center_, Real radius_, int object_, int patch_)
        : center(center_),
          radius(radius_),
          reach2(radius_ * radius_ * (1 + 32 * std::numeric_limits<Real>::epsilon())),
          object(object_),
          patch(patch_) {}
};

template <typename Real>
struct Polyhedron {
    int first_plane, plane_count;  // of the scene's patches
    int object;
};

// ---- Sphere -------------------------------------------------------------------------------------------------------

// With g = center - origin, the roots of t^2 - 2 (g.d) t + g.g - r^2 = 0. The discriminant is r^2 - |g - (g.d) d|^2,
// which does not cancel for a small sphere far away, and the roots are q = g.d +- sqrt(...), of the sign that adds, and
// (g.g - r^2) / q. Haines, Guenther and Akenine-Moller, "Precision Improvements for Ray/Sphere Intersection", Ray
// Tracing Gems, 2019, ch. 7.
//
// Returns false, with nothing said about where, if no ray crosses the sphere.
template <typename Real>
[[gnu::always_inline]] inline bool find_crossing(const Sphere<Real>& sphere, const Rays<Real>& rays,
                                                 Crossing<Real>& crossing) {
    using L = Lanes<Real>;
    const L zero = Real(0);
    const L infinity = std::numeric_limits<Real>::infinity();

    const Vector<L> g = Vector<L>(sphere.center) - rays.origin;
    const L closest = dot(g, rays.direction);  // where the ray passes the centre
    const Vector<L> across = g - closest * rays.direction;
    const L across2 = dot(across, across);
    const Mask<Real> near_enough = across2 <= L(sphere.reach2);
    if (!any(near_enough)) {
        return false;
    }
    const Mask<Real> starts_here = rays.object == Indices<Real>(sphere.object);
    const Mask<Real> left_outward = starts_here & ~rays.inside;
    if (!any(near_enough & ~left_outward)) {
        return false;
    }

    const L radius2 = L(sphere.radius) * L(sphere.radius);
    const L discriminant = radius2 - across2;
    const L root = sqrt(max(discriminant, zero));
    const L q = closest + select(closest >= zero, root, -root);
    const L other = (dot(g, g) - radius2) / q;
    const L near = min(q, other);
    const L far = max(q, other);
    const Mask<Real> enters = near > rays.t_min;
    const L t = select(enters, near, select(far > rays.t_min, far, infinity));
    crossing.t = select(discriminant >= zero, t, infinity);
    crossing.patch = sphere.patch;
    crossing.inside = ~enters;
    if (any(starts_here)) {
        // With the origin on the sphere, the roots are 0 and 2 g.d, and only the second, from within, is a hit.
        const L through = closest + closest;
        const L own = select(left_outward | (through <= zero), infinity, through);
        crossing.t = select(starts_here, own, crossing.t);
        crossing.inside |= starts_here;
    }
    return true;
}

// A sphere as seen from a point, such as the eye or a light: tells most lines through the point that miss the sphere,
// for less than half of what find_crossing() costs. Such a line, of direction d, passes the centre at a distance whose
// square is g.g - (g.d)^2, with g = center - point. That difference cancels for a small sphere far away, so it only
// counts where it is larger than its error.
template <typename Real>
class Sight {
 public:
    using L = Lanes<Real>;

    Sight(const Sphere<Real>& sphere, const Vector<Real>& point)
        : center_(sphere.center),
          g_(sphere.center - point),
          outside2_((1 - slack) * dot(g_, g_) - (1 + slack) * sphere.reach2),
          inside2_((1 - slack) * sphere.reach2),
          encloses_((1 + slack) * dot(g_, g_) < inside2_) {}

    // Whether rays from the point may hit the sphere.
    Mask<Real> may_be_hit(const Vector<L>& direction) const { return may_meet(direction, L(Real(0))); }

    // Whether the sphere may be between the point and the origins of rays that lead to it.
    Mask<Real> may_block(const Rays<Real>& rays, L distance) const {
        if (encloses_) {
            const Vector<L> g = Vector<L>(center_) - rays.origin;
            return ~(dot(g, g) < L(inside2_));
        }
        // The rays pass the point at some distance, for their directions are rounded.
        return may_meet(rays.direction, L(slack) * distance * distance);
    }

 private:
    static constexpr Real slack = 128 * std::numeric_limits<Real>::epsilon();

    Mask<Real> may_meet(const Vector<L>& direction, L error2) const {
        const L closest = dot(Vector<L>(g_), direction);
        return ~(closest * closest + error2 < L(outside2_));  // also where a square is too large for a number
    }

    Vector<Real> center_, g_;
    Real outside2_;  // g.g - r^2, and less by more than the error
    Real inside2_;   // r^2, likewise
    bool encloses_;  // the point lies in the sphere, and a ball holds all between two of its points
};

// ---- Convex polyhedron --------------------------------------------------------------------------------------------

// The ray is inside all half-spaces between the largest t at which it enters one and the smallest at which it leaves
// one. Planes may be few and close no volume: either bound may stay infinite. Where planes tie, the first one counts.
// Haines, "Fast Ray-Convex Polyhedron Intersection", Graphics Gems II, 1991.
//
// Returns false, with nothing said about where, if no ray crosses the polyhedron.
template <typename Real>
[[gnu::always_inline]] inline bool find_crossing(const Polyhedron<Real>& polyhedron, const Patch<Real>* planes,
                                                 const Rays<Real>& rays, Crossing<Real>& crossing) {
    using L = Lanes<Real>;
    const L zero = Real(0);
    const L infinity = std::numeric_limits<Real>::infinity();
    const Mask<Real> starts_here = rays.object == Indices<Real>(polyhedron.object);
    const Mask<Real> from_within = starts_here & rays.inside;

    L t_enter = -infinity;
    L t_leave = infinity;
    Indices<Real> patch_enter = -1;
    Indices<Real> patch_leave = -1;
    Mask<Real> misses = starts_here & ~rays.inside;
    if (all(misses)) {
        return false;
    }

    const int end = polyhedron.first_plane + polyhedron.plane_count;
    for (int k = polyhedron.first_plane; k < end; ++k) {
        const Patch<Real>& plane = planes[k];
        const Vector<L> normal(plane.anchor);
        const L slope = dot(normal, rays.direction) + zero;  // never -0
        const L height = dot(normal, rays.origin) + L(plane.size);
        const L t = -height / slope;
        const Indices<Real> patch = k;

        // A ray along the plane leaves it at -infinity if it runs outside, at +infinity if inside, and at no number,
        // which compares with none, if within the plane itself.
        const Mask<Real> entering = slope < zero;
        const Mask<Real> enters_last = entering & (t > t_enter);
        const Mask<Real> leaves_first = ~entering & (t < t_leave) & ~(from_within & (rays.patch == patch));
        t_enter = select(enters_last, t, t_enter);
        t_leave = select(leaves_first, t, t_leave);
        patch_enter = select(enters_last, patch, patch_enter);
        patch_leave = select(leaves_first, patch, patch_leave);

        misses |= ((t_enter > t_leave) | (t_leave < rays.t_min)) & ~from_within;
        if (all(misses)) {
            return false;
        }
    }

    const Mask<Real> enters = (t_enter > rays.t_min) & ~from_within;
    const L exit = select(from_within, max(t_leave, zero), select(t_leave > rays.t_min, t_leave, infinity));
    crossing.t = select(misses, infinity, select(enters, t_enter, exit));
    crossing.patch = select(enters, patch_enter, patch_leave);
    crossing.inside = ~enters;
    return true;
}

}  // namespace whitted::WHITTED_ISA
