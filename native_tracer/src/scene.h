// A scene, prepared for one precision, and the two questions rays ask of it: what is hit first, and whether anything
// is in the way.

#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <variant>
#include <vector>

#include "camera.h"
#include "description.h"
#include "pigment.h"
#include "surface.h"

namespace whitted::WHITTED_ISA {

// All spheres, as seen from one point.
template <typename Real>
using View = std::vector<Sight<Real>>;

template <typename Real>
struct Light {
    Vector<Real> position;
    Color<Real> color;
    Real a, b, c;  // dimmed by 1 / (a + b d + c d^2) at distance d
    View<Real> view;
};

template <typename Real>
struct Finish {
    Real ka, kd, ks, alpha, kr, kt;
    Real eta;  // n1/n2, outside over inside
};

template <typename Real>
struct Object {
    Finish<Real> finish;
    const Pigment<Real>* pigment;
    int first_patch;
};

template <typename Real>
struct Hits {
    Lanes<Real> t = std::numeric_limits<Real>::infinity();
    Indices<Real> object = -1;  // -1: nothing is hit
    Indices<Real> patch = -1;
    Mask<Real> inside = Mask<Real>::none();
};

// The surface that rays have hit.
template <typename Real>
struct Surface {
    using L = Lanes<Real>;
    Mask<Real> hit;
    Vector<L> point, outward, normal;  // `normal` is turned toward the viewer
    L error;                           // of `point`
    Color<L> pigment;
    L ka, kd, ks, alpha, kr, kt, eta;
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
    for (const auto member : {&S::ka, &S::kd, &S::ks, &S::alpha, &S::kr, &S::kt, &S::eta}) {
        put(member);
    }
}

template <typename Real>
struct Scene {
    Color<Real> ambient, background;
    View<Real> eye_view;
    std::vector<Light<Real>> lights;
    std::vector<Pigment<Real>> pigments;
    std::vector<Object<Real>> objects;
    std::vector<Patch<Real>> patches;
    std::vector<Sphere<Real>> spheres;
    std::vector<Polyhedron<Real>> polyhedra;

    explicit Scene(const SceneDescription& description);
    Scene(const Scene&) = delete;  // objects point to pigments

    // The nearest hit of each ray; of objects at the same distance, the first of the file.
    Hits<Real> nearest_hit(const Rays<Real>& rays, const View<Real>* view) const {
        Hits<Real> hits;
        const auto may_hit = [&](std::size_t sphere) {
            return !view || any((*view)[sphere].may_be_hit(rays.direction));
        };
        for_each_crossing(rays, may_hit, [&](Indices<Real> object, const Crossing<Real>& crossing) {
            const Mask<Real> nearer = (crossing.t < hits.t) | ((crossing.t <= hits.t) & (object < hits.object));
            hits.t = select(nearer, crossing.t, hits.t);
            hits.object = select(nearer, object, hits.object);
            hits.patch = select(nearer, crossing.patch, hits.patch);
            hits.inside = select(nearer, crossing.inside, hits.inside);
            return true;
        });
        return hits;
    }

    // An object that is in the way of each ray before `distance`, or -1: nothing is; for the rays in `wanted`.
    Indices<Real> blocker(const Rays<Real>& rays, const Light<Real>& light, Lanes<Real> distance,
                          Mask<Real> wanted) const {
        Indices<Real> blocker = -1;
        Mask<Real> open = wanted;
        const auto may_hit = [&](std::size_t sphere) {
            return any(open & light.view[sphere].may_block(rays, distance));
        };
        for_each_crossing(rays, may_hit, [&](Indices<Real> object, const Crossing<Real>& crossing) {
            const Mask<Real> blocked = open & (crossing.t < distance);
            blocker = select(blocked, object, blocker);
            open &= ~blocked;
            return any(open);
        });
        return blocker;
    }

 private:
    // Calls visit(object, crossing) for the objects that some ray crosses, until it returns false: the one place that
    // knows how the objects are searched.
    template <typename MayHit, typename Visit>
    [[gnu::always_inline]] void for_each_crossing(const Rays<Real>& rays, MayHit may_hit, Visit visit) const {
        Crossing<Real> crossing;
        for (std::size_t i = 0; i < spheres.size(); ++i) {
            if (may_hit(i) && find_crossing(spheres[i], rays, crossing) && !visit(spheres[i].object, crossing)) {
                return;
            }
        }
        for (const Polyhedron<Real>& polyhedron : polyhedra) {
            if (find_crossing(polyhedron, patches.data(), rays, crossing) && !visit(polyhedron.object, crossing)) {
                return;
            }
        }
    }
};

// ---- Preparation --------------------------------------------------------------------------------------------------

template <typename Real>
Patch<Real> plane_of(const Quadruple& plane) {
    // A normal may have any length: its square must neither overflow nor vanish, in float too.
    const int exponent = std::ilogb(std::max({std::abs(plane[0]), std::abs(plane[1]), std::abs(plane[2])}));
    const auto scaled = [&](std::size_t i) { return std::scalbn(plane[i], -exponent); };
    const Vector<Real> normal = vector_of<Real>({scaled(0), scaled(1), scaled(2)});
    return {normal / length(normal), static_cast<Real>(scaled(3)) / length(normal), false};
}

template <typename Real>
Scene<Real>::Scene(const SceneDescription& description)
    : ambient(vector_of<Real>(description.ambient)), background(vector_of<Real>(description.background)) {
    const auto real = [](double value) { return static_cast<Real>(value); };
    for (const LightDescription& light : description.lights) {
        lights.push_back({vector_of<Real>(light.position),
                          vector_of<Real>(light.color),
                          real(light.attenuation[0]),
                          real(light.attenuation[1]),
                          real(light.attenuation[2]),
                          {}});
    }
    for (const PigmentDescription& pigment : description.pigments) {
        pigments.push_back(pigment_of<Real>(pigment));
    }
    objects.reserve(description.objects.size());
    for (const ObjectDescription& object : description.objects) {
        const auto index = static_cast<int>(objects.size());
        const auto patch = static_cast<int>(patches.size());
        const FinishDescription& f = description.finishes[static_cast<std::size_t>(object.finish)];
        objects.push_back({{real(f.ka), real(f.kd), real(f.ks), real(f.alpha), real(f.kr), real(f.kt), real(f.eta)},
                           &pigments[static_cast<std::size_t>(object.pigment)],
                           patch});
        if (const auto* sphere = std::get_if<SphereDescription>(&object.shape)) {
            patches.push_back({vector_of<Real>(sphere->center), real(sphere->radius), true});
            spheres.emplace_back(patches.back().anchor, patches.back().size, index, patch);
        } else {
            const auto& planes = std::get_if<PolyhedronDescription>(&object.shape)->planes;
            for (const Quadruple& plane : planes) {
                patches.push_back(plane_of<Real>(plane));
            }
            polyhedra.push_back({patch, static_cast<int>(planes.size()), index});
        }
    }
    const auto view_from = [&](const Vector<Real>& point) {
        View<Real> view;
        for (const Sphere<Real>& sphere : spheres) {
            view.emplace_back(sphere, point);
        }
        return view;
    };
    eye_view = view_from(vector_of<Real>(description.camera.eye));
    for (Light<Real>& light : lights) {
        light.view = view_from(light.position);
    }
}

}  // namespace whitted::WHITTED_ISA
