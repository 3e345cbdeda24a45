// What rays hit first.

#pragma once

#include <limits>

#include "shapes/crossing.h"
#include "shapes/shapes.h"
#include "tracing/hits.h"
#include "tracing/nearest_by_rules.h"
#include "tracing/ray.h"
#include "tracing/rounding.h"
#include "tracing/scene.h"
#include "tracing/traversal.h"
#include "tracing/vector.h"

namespace whitted::WHITTED_ISA {

// A query of traversal.h, for the nearest crossing of each ray in `wanted`. Where its rivals are is enough to notice a
// tie: it is decided afterwards, by another search.
template <typename Real>
class NearestQuery {
 public:
    static constexpr bool by_rules = false;
    static constexpr bool which_primitive = true;

    NearestQuery(const Rays<Real>& rays, Mask<Real> wanted)
        : limit(select(wanted, hits.t, Lanes<Real>(Real(-1)))), rays_(&rays) {}

    template <typename Sight>
    [[gnu::always_inline]] bool may_meet(const Sight& sight) const {
        return sight.may_be_hit(rays_->direction);
    }

    template <typename Shape>
    [[gnu::always_inline]] bool meet(const Shape& shape, const Crossing<Real>& crossing) {
        const Indices<Real> object = shape.object();
        const Mask<Real> nearer = (crossing.t < hits.t) | ((crossing.t <= hits.t) & (object < hits.object));
        second = min(second, max(crossing.t, hits.t));
        hits.put(nearer, {crossing.t, object, crossing.primitive, crossing.inside});
        limit = min(hits.t, limit);
        return true;
    }

    Hits<Real> hits;
    Lanes<Real> limit;
    Lanes<Real> second = std::numeric_limits<Real>::infinity();  // distance of the next one
    Mask<Real> close = Mask<Real>::none();

 private:
    const Rays<Real>* rays_;
};

// The nearest hit of each ray; of objects at the same distance, the first of the file; for the rays in `wanted`, which
// start where `view` was made from, if it is given.
template <typename Real>
inline Hits<Real> nearest_hit(const Scene<Real>& scene, const Rays<Real>& rays, Mask<Real> wanted,
                              const View<Real>* view) {
    NearestQuery<Real> nearest(rays, wanted);
    traverse(scene, rays, view, nearest);
    Hits<Real>& hits = nearest.hits;
    const Lanes<Real> range = Lanes<Real>(most_blur<Real>) * (hits.t + rays.reach);
    const Mask<Real> close = (nearest.close | (nearest.second - hits.t <= range) | (hits.t < range)) & wanted;
    if (decides_ties<Real> && any(close)) [[unlikely]] {
        hits.put(close, nearest_by_rules(scene, rays, close));
    }
    return hits;
}

}  // namespace whitted::WHITTED_ISA
