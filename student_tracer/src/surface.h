// The surface that a ray has hit.

#pragma once

#include <limits>

#include "pigment.h"
#include "scene.h"
#include "shapes.h"
#include "vector.h"
#include "world.h"

namespace student {

template <typename Real>
struct Surface {
    Vector<Real> point, outward, normal;  // `normal` is turned to the viewer
    Real normal_length;                   // 1, but for one mistake
    Vector<Real> to_viewer;
    Color<Real> pigment;
    const Finish* finish;
    int object;
    Ray<Real> start;  // what rays that leave it begin with
};

// A bound of the rounding error of a point found at distance t.
template <typename Real>
Real rounding(Vector<Real> point, Real t) {
    return 32 * std::numeric_limits<Real>::epsilon() * (reach(point) + t);
}

// `viewer` is the length of the vector to the viewer.
template <typename Real>
Surface<Real> surface_at(const World<Real>& world, const Ray<Real>& ray, const Hit<Real>& hit, Real viewer) {
    const Switches& on = world.on;
    const Body<Real>& body = world.bodies[std::size_t(hit.object)];
    Surface<Real> surface;
    surface.point = ray.origin + hit.t * ray.direction;
    surface.normal_length = 1;
    if (body.round) {
        const Vector<Real> offset = surface.point - body.center;
        surface.outward = normalize(offset);
        // Back onto the sphere, of which rounding has taken it.
        surface.point = on(On::radius_not_squared) ? surface.point : body.center + body.radius * surface.outward;
        surface.normal_length = on(On::sphere_normal_not_unit) ? length(offset) : Real(1);
    } else {
        const auto& plane = body.planes[std::size_t(hit.plane)];
        surface.outward = plane.normal;
        surface.point = surface.point - (dot(plane.normal, surface.point) + plane.offset) * plane.normal;
        surface.normal_length = on(On::plane_normal_not_unit) ? plane.length : Real(1);
    }
    surface.normal = hit.inside && !on(On::normal_not_turned) ? -surface.outward : surface.outward;
    surface.to_viewer = -viewer * ray.direction;
    surface.pigment = color_at(world.pigment_of(hit.object), surface.point, on);
    surface.finish = &world.finish_of(hit.object);
    surface.object = hit.object;
    surface.start = {surface.point, {}, rounding(surface.point, hit.t), hit.object, hit.plane, hit.inside};
    if (world.epsilon >= 0) {  // a program that knows nothing of the surface, and keeps a distance
        surface.start.t_min = world.epsilon;
        surface.start.object = -1;
    }
    return surface;
}

}  // namespace student
