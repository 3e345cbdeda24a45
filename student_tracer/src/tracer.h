// A ray tracer as a student writes it: one ray after the other, one function for each formula of the statement, and in
// each the ways in which it is got wrong. With no switch set it draws what the statement asks for.
//
// It shares no code with native_tracer, so that it is an opinion of its own. It is written for reading, not for speed.
// Here is the recursion; world.h has the scene, shapes.h where rays meet it, and lighting.h a surface's own colour.

#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "camera.h"
#include "deviations.h"
#include "lighting.h"
#include "record.h"
#include "scene.h"
#include "shapes.h"
#include "surface.h"
#include "vector.h"
#include "world.h"

namespace student {

template <typename Real>
class Tracer {
 public:
    using V = Vector<Real>;
    using C = Color<Real>;

    Tracer(const Scene& scene, Size size, const Switches& switches)
        : on(switches),
          size_(size),
          view_(scene.camera, drawn_size(size, switches), switches),
          world_(scene, switches),
          lighting_(world_) {}

    // Parts refer to each other.
    Tracer(const Tracer&) = delete;
    Tracer& operator=(const Tracer&) = delete;

    // The colour of pixel (x, y), neither clamped nor rounded; its rays are added to `record`, if there is one.
    C pixel(int x, int y, Record* record = nullptr) const {
        const V direction = view_.direction(place_of(x, y, size_, on));
        const V eye = vector_of<Real>(world_.scene.camera.eye);
        const Ray<Real> ray{eye, normalize(direction), rounding(eye, Real(0))};
        return trace(ray, on(On::direction_not_unit) ? length(direction) : Real(1), {}, record);
    }

 private:
    // Where a ray is in the tree of its pixel's rays.
    struct Branch {
        Real weight = 1;  // the product of the kr and kt on the way to it
        int depth = 0;
        int parent = -1;
        Kind kind = Kind::primary;
    };

    // A ray's colour: local + kr reflected + kt transmitted. `viewer` is the length of the vector to the viewer.
    C trace(const Ray<Real>& ray, Real viewer, const Branch& branch, Record* record) const {
        const Hit<Real> hit = world_.nearest_hit(ray);
        const int index =
            record ? record->add(branch.parent, branch.kind, branch.depth, double(branch.weight), ray) : -1;
        if (hit.object < 0) {
            const C color = branch.depth > 0 && on(On::background_primary_only) ? C{} : world_.background;
            if (record) {
                record->rays[std::size_t(index)].local = triple(color);
            }
            return color;
        }
        const Surface<Real> surface = surface_at(world_, ray, hit, viewer);
        if (record) {
            record->hit(index, hit, surface.point, surface.outward, surface.pigment,
                        world_.bodies[std::size_t(hit.object)].round);
        }
        const Finish& finish = *surface.finish;
        C color = lighting_.local_color(surface, record, index);
        // A factor of 1 does not make the tree of rays larger: `weight` decides that, and is as it was.
        const Real kr = factor(finish.kr, finish.kt, on(On::kr_ignored) || (on(On::kr_inside_ignored) && hit.inside));
        const Real kt = factor(finish.kt, finish.kr, on(On::kt_ignored));
        if (kr > 0) {
            const C tint = on(On::mirrored_tinted) ? surface.pigment : C{1, 1, 1};
            const Real counted = on(On::kr_full) ? 1 : on(On::ks_for_kr) ? static_cast<Real>(finish.ks) : kr;
            color +=
                counted * tint *
                follow(mirrored(ray, surface), {kr * branch.weight, branch.depth + 1, index, Kind::reflected}, record);
        }
        if (kt > 0) {
            const C tint = on(On::transmitted_tinted) ? surface.pigment : C{1, 1, 1};
            const Real counted = on(On::kt_full) ? 1 : kt;
            bool dark = false, total = false;
            const Ray<Real> next = transmitted(ray, hit, surface, dark, total);
            if (record) {
                record->rays[std::size_t(index)].total_reflection = total;
            }
            if (!dark) {
                color += counted * tint *
                         follow(next, {kt * branch.weight, branch.depth + 1, index, Kind::transmitted}, record);
            }
        }
        return on(On::clamped_per_ray) ? clamped(color) : color;
    }

    // kr or kt of a finish, of which `other` is the other one.
    Real factor(double own, double other, bool ignored) const {
        return ignored ? Real(0) : static_cast<Real>(on(On::kr_kt_exchanged) ? other : own);
    }

    // The colour that a secondary ray brings, if it is followed.
    C follow(const Ray<Real>& ray, const Branch& branch, Record* record) const {
        const bool light = branch.weight < world_.cutoff;
        if (light || branch.depth > world_.max_depth) {
            if (record) {
                record->drop(branch.parent, branch.kind, light);
            }
            return on(On::deepest_is_background) ? world_.background : C{};
        }
        return trace(ray, 1, branch, record);
    }

    // ---- Secondary rays ---------------------------------------------------------------------------------------------

    Ray<Real> mirrored(const Ray<Real>& ray, const Surface<Real>& surface) const {
        Ray<Real> next = surface.start;
        const V& n = surface.normal;
        next.direction = normalize(ray.direction - 2 * dot(ray.direction, n) * n);
        return next;
    }

    // Snell's law; where it has no answer, the transmitted ray follows the mirror direction.
    Ray<Real> transmitted(const Ray<Real>& ray, const Hit<Real>& hit, const Surface<Real>& surface, bool& dark,
                          bool& total) const {
        Ray<Real> next = surface.start;
        next.inside = !hit.inside;
        const V& n = surface.normal;
        const Real cosine = -dot(ray.direction, n);
        const Real eta = eta_of(*surface.finish, hit.inside);
        const Real cosine2 = (1 - eta) * (1 + eta) + eta * cosine * (eta * cosine);
        total = cosine2 < 0;
        if (on(On::ior_ignored) || (total && on(On::total_reflection_straight))) {
            next.direction = ray.direction;
        } else if (total && !on(On::total_reflection_along)) {
            dark = on(On::total_reflection_black);
            return mirrored(ray, surface);
        } else {
            next.direction =
                normalize(eta * ray.direction + (eta * cosine - std::sqrt(std::max(cosine2, Real(0)))) * n);
        }
        return next;
    }

    // The ratio of the index on the ray's side to the one on the other.
    Real eta_of(const Finish& finish, bool inside) const {
        double eta = finish.eta;  // n1/n2
        if (on(On::ior_inverted)) {
            eta = 1 / eta;
        } else if (on(On::ior_is_ratio)) {
            eta = finish.ior;
        } else if (on(On::ior_is_index)) {
            eta = 1 / finish.ior;
        }
        return static_cast<Real>(inside && !on(On::ior_not_inverted_inside) ? 1 / eta : eta);
    }

    const Switches& on;
    Size size_;
    View<Real> view_;
    World<Real> world_;
    Lighting<Real> lighting_;
};

}  // namespace student
