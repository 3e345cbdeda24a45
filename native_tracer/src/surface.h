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
#include <type_traits>

#include "ray.h"
#include "rounding.h"
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
    // How far it may be off, and by how much more for each unit of a coordinate.
    Real error = 0, error_by_reach = 0;
    Real curvature = 0;

    // How far it may be off where rays of that reach are compared with it, see Rays.
    Lanes<Real> error_at(Lanes<Real> reach) const { return Lanes<Real>(error) + Lanes<Real>(error_by_reach) * reach; }
};

template <typename Real>
struct Sphere {
    Vector<Real> center;
    Real radius;
    Real error;   // how far the surface may be off
    Real reach2;  // a line farther from the centre than its root misses, whatever was rounded
    Real diameter;
    Real touching, most_touching;  // of a line that touches it, the discriminant for its error, and at most
    int object, patch;

    Sphere(const Patch<Real>& sphere, int object_, int patch_)
        : center(sphere.anchor),
          radius(sphere.size),
          error(sphere.error),
          reach2(radius * radius * (1 + 32 * std::numeric_limits<Real>::epsilon())),
          diameter(2 * radius),
          touching(diameter * error),
          most_touching(most_blur<Real> * radius * radius),
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

    const L radius = sphere.radius;
    const L radius2 = radius * radius;
    const L discriminant = radius2 - across2;
    // A ray that touches the sphere passes it by.
    const L touching = min(L(sphere.diameter) * (rays.t_min + abs(closest) * rays.spread) + L(sphere.touching),
                           L(sphere.most_touching));
    const L root = sqrt(max(discriminant, zero));
    const L q = closest + select(closest >= zero, root, -root);
    const L other = (dot(g, g) - radius2) / q;
    const L near = min(q, other);
    const L far = max(q, other);
    const Mask<Real> enters = near > rays.t_min;
    const L t = select(enters, near, select(far > rays.t_min, far, infinity));
    crossing.t = select(discriminant > touching, t, infinity);
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

// Of rays that start on the sphere by the roundings of their origins only, and not by knowledge: there they do not meet
// it.
template <typename Real>
void decide_start(const Sphere<Real>& sphere, const Rays<Real>& rays, Crossing<Real>& crossing) {
    using L = Lanes<Real>;
    const Vector<L> g = Vector<L>(sphere.center) - rays.origin;
    // Of a sphere smaller than such errors nothing is known.
    const L error = rays.t_min + L(sphere.error);
    const Mask<Real> starts = (abs(length(g) - L(sphere.radius)) <= error) &
                              (error <= L(most_blur<Real>) * L(sphere.radius)) &
                              ~(rays.object == Indices<Real>(sphere.object));
    const L through = L(2) * dot(g, rays.direction);
    const Mask<Real> crosses = (through > rays.t_min) & (crossing.t < L(std::numeric_limits<Real>::infinity()));
    crossing.t = select(starts, select(crosses, through, L(std::numeric_limits<Real>::infinity())), crossing.t);
    crossing.inside |= starts;
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
// one. Planes may be few and close no volume: either bound may stay infinite.
// Haines, "Fast Ray-Convex Polyhedron Intersection", Graphics Gems II, 1991.
template <typename Real>
struct Passage {
    using L = Lanes<Real>;
    L enter = -std::numeric_limits<Real>::infinity();
    L leave = std::numeric_limits<Real>::infinity();
    Indices<Real> enter_patch = -1;
    Indices<Real> leave_patch = -1;
    Mask<Real> misses;
};

// Where rays cross a polyhedron through which they have the given passage; those `from_within` start on it.
template <typename Real>
Crossing<Real> crossing_of(const Passage<Real>& passage, const Rays<Real>& rays, Mask<Real> from_within) {
    using L = Lanes<Real>;
    const L zero = Real(0);
    const L infinity = std::numeric_limits<Real>::infinity();
    const Mask<Real> enters = (passage.enter > rays.t_min) & ~from_within;
    const L leave =
        select(from_within, max(passage.leave, zero), select(passage.leave > rays.t_min, passage.leave, infinity));
    return {select(passage.misses, infinity, select(enters, passage.enter, leave)),
            select(enters, passage.enter_patch, passage.leave_patch), ~enters};
}

// Decides ties by the format's rules: a ray along a plane neither enters nor leaves there, and is inside or outside by
// its height; one that meets an edge hits, so that bodies which share the edge leave no gap.
template <typename Real>
[[gnu::noinline]] Crossing<Real> find_crossing_by_rules(const Polyhedron<Real>& polyhedron, const Patch<Real>* planes,
                                                        const Rays<Real>& rays) {
    using L = Lanes<Real>;
    const L zero = Real(0);
    const Mask<Real> starts_here = rays.object == Indices<Real>(polyhedron.object);
    const Mask<Real> from_within = starts_here & rays.inside;
    Passage<Real> passage;
    passage.misses = starts_here & ~rays.inside;
    L enter_error = zero;
    L leave_error = zero;
    const int end = polyhedron.first_plane + polyhedron.plane_count;
    for (int k = polyhedron.first_plane; k < end; ++k) {
        const Patch<Real>& plane = planes[k];
        const Vector<L> normal(plane.anchor);
        const L slope = dot(normal, rays.direction);
        const L height = dot(normal, rays.origin) + L(plane.size);
        const L error = rays.t_min + plane.error_at(rays.reach);
        const Indices<Real> patch = k;
        const L t = select(abs(height) <= error, zero, -height / slope);
        const L t_error = (error + abs(t) * rays.spread) / abs(slope);

        const Mask<Real> along = abs(slope) <= rays.spread;
        const Mask<Real> enters_last = ~along & (slope < zero) & (t > passage.enter);
        const Mask<Real> leaves_first =
            ~along & (slope > zero) & (t < passage.leave) & ~(from_within & (rays.patch == patch));
        passage.enter = select(enters_last, t, passage.enter);
        passage.leave = select(leaves_first, t, passage.leave);
        passage.enter_patch = select(enters_last, patch, passage.enter_patch);
        passage.leave_patch = select(leaves_first, patch, passage.leave_patch);
        enter_error = select(enters_last, t_error, enter_error);
        leave_error = select(leaves_first, t_error, leave_error);
        passage.misses |= along & (height > error) & ~from_within;
    }
    passage.misses |= (passage.enter - passage.leave > enter_error + leave_error) & ~from_within;
    return crossing_of(passage, rays, from_within);
}

// What is known of where rays start.
enum class Start { elsewhere, mixed, within };

// The passage of rays that are far from ties, faster; adds those that are not to `close`.
template <Start start, bool which_piece, typename Real>
[[gnu::always_inline]] inline void pass(const Polyhedron<Real>& polyhedron, const Patch<Real>* planes,
                                        const Rays<Real>& rays, Passage<Real>& passage, Lanes<Real>& between_planes,
                                        Mask<Real>& close) {
    using L = Lanes<Real>;
    const L zero = Real(0);
    const Mask<Real> from_within = (rays.object == Indices<Real>(polyhedron.object)) & rays.inside;
    const int end = polyhedron.first_plane + polyhedron.plane_count;
    for (int k = polyhedron.first_plane; k < end; ++k) {
        const Patch<Real>& plane = planes[k];
        const Vector<L> normal(plane.anchor);
        const L slope = dot(normal, rays.direction);
        const L height = dot(normal, rays.origin) + L(plane.size);
        const L t = -height / slope;
        const Indices<Real> patch = k;
        const Mask<Real> along = abs(slope) <= rays.spread;
        if (any(along)) [[unlikely]] {
            close |= along;
        }

        const Mask<Real> entering = slope < zero;
        if constexpr (which_piece) {
            // No number before the first plane.
            const L before = start == Start::within ? passage.leave : select(entering, passage.enter, passage.leave);
            between_planes = min(abs(t - before), between_planes);
        }
        Mask<Real> leaves_first = ~entering & (t < passage.leave);
        if constexpr (start != Start::elsewhere) {
            leaves_first &= ~(from_within & (rays.patch == patch));
        }
        passage.leave = select(leaves_first, t, passage.leave);
        passage.leave_patch = select(leaves_first, patch, passage.leave_patch);
        if constexpr (start == Start::within) {
            continue;
        }
        const Mask<Real> enters_last = entering & (t > passage.enter);
        passage.enter = select(enters_last, t, passage.enter);
        passage.enter_patch = select(enters_last, patch, passage.enter_patch);

        Mask<Real> misses = (passage.enter > passage.leave) | (passage.leave < rays.t_min);
        if constexpr (start == Start::mixed) {
            misses &= ~from_within;
        }
        passage.misses |= misses;
        if (all(passage.misses)) {
            return;
        }
    }
}

// Returns false, with nothing said about where, if no ray crosses the polyhedron.
template <bool which_piece, typename Real>
[[gnu::always_inline]] inline bool find_crossing(const Polyhedron<Real>& polyhedron, const Patch<Real>* planes,
                                                 const Rays<Real>& rays, Crossing<Real>& crossing, Mask<Real>& close) {
    using L = Lanes<Real>;
    const L zero = Real(0);
    const L infinity = std::numeric_limits<Real>::infinity();
    const Mask<Real> starts_here = rays.object == Indices<Real>(polyhedron.object);
    const Mask<Real> from_within = starts_here & rays.inside;
    const Mask<Real> elsewhere = starts_here & ~rays.inside;
    if (all(elsewhere)) {
        return false;
    }
    Passage<Real> passage;
    passage.misses = elsewhere;
    L between_planes = infinity;
    if (!any(from_within)) {
        pass<Start::elsewhere, which_piece>(polyhedron, planes, rays, passage, between_planes, close);
    } else if (which_piece && all(from_within)) {
        pass<Start::within, which_piece>(polyhedron, planes, rays, passage, between_planes, close);
    } else {
        pass<Start::mixed, which_piece>(polyhedron, planes, rays, passage, between_planes, close);
    }
    // Later planes only bring the ends of the passage farther apart.
    const L gap = passage.enter - passage.leave;
    const Mask<Real> at_edge = (gap > zero) & (gap <= L(most_blur<Real>) * (rays.reach + passage.enter)) & ~elsewhere;
    if (any(at_edge)) [[unlikely]] {
        close |= at_edge;
    }
    if (all(passage.misses)) {
        return false;
    }
    crossing = crossing_of(passage, rays, from_within);
    if constexpr (which_piece) {
        close |= (between_planes < L(most_blur<Real>) * (rays.reach + crossing.t)) & (crossing.t < infinity);
    }
    return true;
}

}  // namespace whitted::WHITTED_ISA
