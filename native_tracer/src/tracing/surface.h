// The surface that rays have hit, as shading needs it.

#pragma once

#include <cstddef>

#include "shapes/moving.h"
#include "tracing/hits.h"
#include "tracing/pigment.h"
#include "tracing/ray.h"
#include "tracing/rounding.h"
#include "tracing/scene.h"
#include "tracing/vector.h"

namespace whitted::WHITTED_ISA {

template <typename Real>
struct Surface {
    using L = Lanes<Real>;
    Mask<Real> hit;
    Vector<L> point, outward, normal;  // `normal` is turned toward the viewer
    L error;                           // a bound of `point`'s rounding error, for t_min
    L lean;                            // how far the normal may be off
    Color<L> pigment;
    L ka, kd, ks, alpha, kr, kt, eta;

    void put(const Finish<Real>& finish) {
        ka = finish.ka;
        kd = finish.kd;
        ks = finish.ks;
        alpha = finish.alpha;
        kr = finish.kr;
        kt = finish.kt;
        eta = finish.eta;
    }
};

// Puts the lanes of `other` that the mask names into `surface`.
template <typename Real>
void merge(Mask<Real> mask, const Surface<Real>& other, Surface<Real>& surface) {
    const auto put = [&](auto member) { surface.*member = select(mask, other.*member, surface.*member); };
    using S = Surface<Real>;
    put(&S::point);
    put(&S::outward);
    put(&S::normal);
    put(&S::error);
    put(&S::pigment);
    for (const auto member : {&S::lean, &S::ka, &S::kd, &S::ks, &S::alpha, &S::kr, &S::kt, &S::eta}) {
        put(member);
    }
}

// Puts where rays have hit a primitive of an object that stands still into `surface`, and returns what its pigment
// needs.
template <typename Real>
[[gnu::always_inline]] inline Meeting<Real> meet(const Scene<Real>& scene, const Object<Real>& object, int primitive,
                                                 const Rays<Real>& rays, const Hits<Real>& hits,
                                                 Surface<Real>& surface) {
    using L = Lanes<Real>;
    const Vector<L> near = rays.origin + hits.t * rays.direction;
    const auto moved = scene.shapes.visit(object.shape, [&](const auto& shape) __attribute__((always_inline)) {
        return shape.surface_at(primitive, near, rays, hits.inside);
    });
    surface.point = moved.point;
    surface.outward = moved.outward;
    surface.normal = select(hits.inside, -surface.outward, surface.outward);
    const L reach = max_norm(surface.point);
    const L off = decides_ties<Real> ? rays.t_min + moved.error + hits.t * rays.spread : L(Real(0));
    const L blur = L(most_blur<Real>) * (reach + hits.t);
    // A ray that is off meets the surface farther off the more it slants.
    const L along = min(off / abs(dot(surface.outward, rays.direction)), blur);
    surface.error = rounding_error(reach, hits.t) + along;
    surface.lean = moved.curvature * surface.error;
    return {surface.point, surface.outward, rays.direction, off, blur};
}

// The same where the object moves: as it stands still, and taken along from there. Its pigment moves with it.
template <typename Real>
[[gnu::noinline]] Meeting<Real> meet_moving(const Scene<Real>& scene, const Object<Real>& object, int primitive,
                                            const Rays<Real>& rays, const Hits<Real>& hits, Surface<Real>& surface) {
    const Moving<Real>& moving = scene.shapes.template at<Moving<Real>>(object.shape);
    const Meeting<Real> met = meet(scene, object, primitive, moving.bring_back(rays), hits, surface);
    moving.take_along(rays.time, surface.point, surface.error);
    return met;
}

// Where rays have hit; `observer` is told of the pigments there, see observer.h.
template <typename Real, typename Observer>
Surface<Real> surface_at(const Scene<Real>& scene, const Rays<Real>& rays, const Hits<Real>& hits, Observer& observer) {
    const Mask<Real> hit = hits.object >= 0;

    // Neighbouring rays mostly hit the same primitive: then there is nothing to select.
    Surface<Real> result, another;
    bool first = true;
    for_each_distinct(hits.primitive, hit, [&](int primitive, int lane, Mask<Real> same) {
        const Object<Real>& object = scene.objects[static_cast<std::size_t>(hits.object[lane])];
        Surface<Real>& surface = first ? result : another;
        surface.hit = hit;
        const Meeting<Real> met = object.moves ? meet_moving(scene, object, primitive, rays, hits, surface)
                                               : meet(scene, object, primitive, rays, hits, surface);
        surface.pigment = color_at(*object.pigment, met);
        observer.pigment(*object.pigment, met, first ? hit : same);
        surface.put(object.finish);
        if (!first) {
            merge(same, another, result);
        }
        first = false;
    });
    return result;
}

}  // namespace whitted::WHITTED_ISA
