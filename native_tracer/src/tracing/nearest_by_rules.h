// What rays hit first where they meet several things at once, but for rounding errors: the first object of the file
// among those that tie with the nearest, and of that the first primitive. In which order shapes are visited does not
// matter, also where one ties with two that do not tie with one another.

#pragma once

#include <cmath>
#include <cstddef>
#include <limits>

#include "shapes/crossing.h"
#include "shapes/moving.h"
#include "tracing/hits.h"
#include "tracing/ray.h"
#include "tracing/rounding.h"
#include "tracing/scene.h"
#include "tracing/traversal.h"
#include "tracing/vector.h"

namespace whitted::WHITTED_ISA {

// How far the distances of crossings may be off, as far as ties go by it.
template <typename Shape, typename Real>
Lanes<Real> tie_errors(const Shape& shape, const Rays<Real>& world_rays, const Crossing<Real>& crossing) {
    const Rays<Real>& rays = at_rest(shape, world_rays);
    return Lanes<Real>::gather([&](int lane) {
        const Real t = crossing.t[lane];
        return std::isfinite(t) ? tie_error(shape, rays, lane, crossing.primitive[lane], t) : Real(0);
    });
}

// A query of traversal.h, for the least distance, and how far that may be off.
template <typename Real>
struct LeastDistanceQuery {
    static constexpr bool by_rules = true;

    const Rays<Real>& rays;
    Lanes<Real> limit;
    Mask<Real> close = Mask<Real>::none();
    Lanes<Real> least = std::numeric_limits<Real>::infinity();
    Lanes<Real> error = Real(0);

    template <typename Sight>
    bool may_meet(const Sight&) const {
        return true;
    }

    template <typename Shape>
    [[gnu::always_inline]] bool meet(const Shape& shape, const Crossing<Real>& crossing) {
        const Lanes<Real> its_error = tie_errors(shape, rays, crossing);
        const Mask<Real> same = (crossing.t <= least) & (its_error > error);
        error = select((crossing.t < least) | same, its_error, error);
        least = min(crossing.t, least);
        limit = min(least, limit);
        return true;
    }
};

// Another, for the first object of the file whose distance may be the least.
template <typename Real>
struct FirstThatTiesQuery {
    static constexpr bool by_rules = true;

    const Rays<Real>& rays;
    const Lanes<Real> least, error;
    const Lanes<Real> limit;
    Mask<Real> close = Mask<Real>::none();
    Hits<Real> hits{};

    template <typename Sight>
    bool may_meet(const Sight&) const {
        return true;
    }

    template <typename Shape>
    [[gnu::always_inline]] bool meet(const Shape& shape, const Crossing<Real>& crossing) {
        const Indices<Real> object = shape.object();
        const Mask<Real> ties = (crossing.t < Lanes<Real>(std::numeric_limits<Real>::infinity())) &
                                (crossing.t - least <= error + tie_errors(shape, rays, crossing));
        const Mask<Real> first = ties & ((hits.object < Indices<Real>(0)) | (object < hits.object));
        hits.put(first, {crossing.t, object, crossing.primitive, crossing.inside});
        return true;
    }
};

template <typename Real>
[[gnu::noinline]] Hits<Real> nearest_by_rules(const Scene<Real>& scene, const Rays<Real>& rays, Mask<Real> wanted) {
    const Lanes<Real> nowhere = Real(-1);
    LeastDistanceQuery<Real> nearest{rays, select(wanted, Lanes<Real>(std::numeric_limits<Real>::infinity()), nowhere)};
    traverse(scene, rays, nullptr, nearest);
    const Lanes<Real> range = Lanes<Real>(most_blur<Real>) * (nearest.least + rays.reach);
    FirstThatTiesQuery<Real> first{rays, nearest.least, nearest.error, select(wanted, nearest.least + range, nowhere)};
    traverse(scene, rays, nullptr, first);
    Hits<Real>& hits = first.hits;
    hits.primitive = Indices<Real>::gather([&](int lane) {
        if (!wanted[lane] || hits.object[lane] < 0) {
            return hits.primitive[lane];
        }
        const Object<Real>& object = scene.objects[static_cast<std::size_t>(hits.object[lane])];
        return scene.shapes.visit(object.shape, [&](const auto& shape) {
            return shape.primitive_met(at_rest(shape, rays), lane, hits.primitive[lane], hits.t[lane],
                                       hits.inside[lane]);
        });
    });
    return hits;
}

}  // namespace whitted::WHITTED_ISA
