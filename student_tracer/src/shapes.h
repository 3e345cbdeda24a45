// Where a ray meets an object, and the surface there.
//
// A ray knows the surface that it starts on, so that it never meets it again by a rounding error: both kinds of shape
// are convex, so that a ray which leaves one outward cannot come back to it, and one that travels inside meets only its
// far side.

#pragma once

#include <cmath>
#include <limits>

#include "deviations.h"
#include "scene.h"
#include "vector.h"

namespace student {

template <typename Real>
struct Ray {
    Vector<Real> origin, direction;
    Real t_min = 0;               // what is nearer is its origin's rounding error
    int object = -1, plane = -1;  // what it starts on
    bool inside = false;          // it travels inside `object`
};

template <typename Real>
struct Hit {
    Real t = std::numeric_limits<Real>::infinity();
    int object = -1;      // -1: nothing
    int plane = -1;       // of a polyhedron
    bool inside = false;  // the surface is met from within
};

// A body, made ready for the tracer.
template <typename Real>
struct Body {
    struct Plane {
        Vector<Real> normal;  // of length 1, outward
        Real offset;
        Real length;  // of the normal as the file has it
    };

    bool missing = false;
    bool round = true;
    Vector<Real> center;
    Real radius = 1, radius2 = 1;
    std::vector<Plane> planes;

    Body(const Object& object, const Switches& on) : round(object.round) {
        if (round) {
            missing = on(On::spheres_missing);
            center = vector_of<Real>(object.center);
            radius = static_cast<Real>(object.radius) / (on(On::radius_is_diameter) ? 2 : 1);
            radius2 = on(On::radius_not_squared) ? radius : radius * radius;
            return;
        }
        missing = on(On::polyhedra_missing) || (on(On::bounded_only) && !object.bounded);
        std::size_t first = 0, end = object.planes.size();
        if (end > 1) {
            first = on(On::first_face_missing) ? 1 : 0;
            end -= on(On::last_face_missing) ? 1 : 0;
        }
        for (std::size_t k = first; k < end; ++k) {
            const auto [a, b, c, d] = object.planes[k];
            const double norm = std::sqrt(a * a + b * b + c * c);
            const double sign = on(On::halfspaces_turned) ? -1 : 1;
            const double offset_sign = on(On::plane_offset_negated) ? -1 : sign;
            planes.push_back({(static_cast<Real>(sign) * vector_of<Real>({a / norm, b / norm, c / norm})),
                              static_cast<Real>(offset_sign * d / norm), static_cast<Real>(norm)});
        }
    }
};

// Meets a sphere: with g = center - origin the roots of t^2 - 2 (g.d) t + g.g - r^2 = 0, computed without the
// difference of nearly equal numbers (Haines et al., Ray Tracing Gems, 2019, ch. 7).
template <typename Real>
Hit<Real> meet_sphere(const Body<Real>& body, const Ray<Real>& ray, bool starts_here, const Switches& on) {
    Hit<Real> hit;
    const Vector<Real> g = body.center - ray.origin;
    const Real closest = dot(g, ray.direction);
    if (starts_here) {
        if (ray.inside && closest > 0 && !on(On::near_root_only)) {
            hit.t = 2 * closest;
            hit.inside = true;
        }
        return hit;
    }
    const Vector<Real> across = g - closest * ray.direction;
    const Real discriminant = body.radius2 - dot(across, across);
    if (!(discriminant > 0)) {
        return hit;
    }
    const Real root = std::sqrt(discriminant);
    const Real q = closest + (closest >= 0 ? root : -root);
    const Real other = (dot(g, g) - body.radius2) / q;
    const Real near = std::min(q, other), far = std::max(q, other);
    if (near > ray.t_min) {
        hit.t = near;
    } else if (far > ray.t_min && !on(On::near_root_only)) {
        hit.t = far;
        hit.inside = true;
    }
    return hit;
}

// Meets a convex polyhedron between the last plane that it enters by and the first that it leaves by (Haines, Graphics
// Gems II, 1991).
template <typename Real>
Hit<Real> meet_polyhedron(const Body<Real>& body, const Ray<Real>& ray, bool starts_here, const Switches& on) {
    const bool from_within = starts_here && ray.inside;
    Hit<Real> hit;
    if (starts_here && !ray.inside) {
        return hit;
    }
    Real enter = -std::numeric_limits<Real>::infinity();
    Real leave = std::numeric_limits<Real>::infinity();
    int enter_plane = -1, leave_plane = -1;
    for (int k = 0; k < static_cast<int>(body.planes.size()); ++k) {
        const auto& plane = body.planes[static_cast<std::size_t>(k)];
        const Real slope = dot(plane.normal, ray.direction);
        const Real height = dot(plane.normal, ray.origin) + plane.offset;
        const Real t = -height / slope;
        constexpr Real along = 4 * std::numeric_limits<Real>::epsilon();
        if (std::abs(slope) <= along) {
            if (height > 0 && !from_within) {
                return hit;
            }
        } else if (slope < 0) {
            if (t > enter) {
                enter = t;
                enter_plane = k;
            }
        } else if (t < leave && !(from_within && ray.plane == k)) {
            leave = t;
            leave_plane = k;
        }
        if ((enter > leave || leave < ray.t_min) && !from_within) {
            return hit;
        }
    }
    if (from_within) {
        leave = std::max(leave, Real(0));
    } else if (enter > ray.t_min) {
        hit.t = enter;
        hit.plane = enter_plane;
        return hit;
    }
    if ((from_within || leave > ray.t_min) && !on(On::enters_only)) {
        hit.t = leave;
        hit.plane = leave_plane;
        hit.inside = true;
    }
    return hit;
}

// Of object number `index`.
template <typename Real>
Hit<Real> meet(const Body<Real>& body, int index, const Ray<Real>& ray, const Switches& on) {
    if (body.missing) {
        return {};
    }
    const bool starts_here = ray.object == index;
    Hit<Real> hit = body.round ? meet_sphere(body, ray, starts_here, on) : meet_polyhedron(body, ray, starts_here, on);
    hit.object = hit.t < std::numeric_limits<Real>::infinity() ? index : -1;
    return hit;
}

}  // namespace student
