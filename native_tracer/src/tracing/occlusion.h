// What is in the way of rays to a light.

#pragma once

#include "shapes/crossing.h"
#include "tracing/light.h"
#include "tracing/ray.h"
#include "tracing/rounding.h"
#include "tracing/scene.h"
#include "tracing/traversal.h"
#include "tracing/vector.h"

namespace whitted::WHITTED_ISA {

// A query of traversal.h, for any object that the rays in `wanted` cross before `distance`, where the light is.
template <typename Real, bool decided_by_rules>
class OccluderQuery {
 public:
    using L = Lanes<Real>;
    static constexpr bool by_rules = decided_by_rules;
    static constexpr bool which_primitive = false;

    OccluderQuery(const Rays<Real>& rays, const Light<Real>& light, L distance, Mask<Real> wanted)
        : limit(select(wanted, distance, L(Real(-1)))),
          rays_(&rays),
          light_(&light),
          distance_(distance),
          range_(L(most_blur<Real>) * rays.reach),
          open_(wanted) {}

    template <typename Sight>
    [[gnu::always_inline]] bool may_meet(const Sight& sight) const {
        return sight.may_block(*rays_, distance_, open_);
    }

    template <typename Shape>
    [[gnu::always_inline]] bool meet(const Shape& shape, const Crossing<Real>& crossing) {
        const Mask<Real> before_light = (crossing.t < distance_) & ~light_->lies_at(crossing, rays_->direction);
        const Mask<Real> blocked = open_ & before_light;
        occluder = select(blocked, Indices<Real>(shape.object()), occluder);
        const Mask<Real> near = crossing.t < range_;
        if (any(blocked & near)) [[unlikely]] {
            close |= blocked & near;
        }
        open_ &= ~blocked;
        limit = select(open_, limit, L(Real(-1)));
        return any(open_);
    }

    L limit;
    Indices<Real> occluder = -1;  // -1: none
    Mask<Real> close = Mask<Real>::none();

 private:
    const Rays<Real>* rays_;
    const Light<Real>* light_;
    L distance_;
    L range_;          // so near its start a ray may have crossed what it starts on
    Mask<Real> open_;  // no occluder is known yet
};

template <typename Real>
[[gnu::noinline]] Indices<Real> occluder_by_rules(const Scene<Real>& scene, const Rays<Real>& rays,
                                                  const Light<Real>& light, Lanes<Real> distance, Mask<Real> wanted) {
    OccluderQuery<Real, true> query(rays, light, distance, wanted);
    traverse(scene, rays, nullptr, query);
    return query.occluder;
}

// An object that is in the way of each ray before `distance`, or -1: nothing is; for the rays in `wanted`.
template <typename Real>
inline Indices<Real> find_occluder(const Scene<Real>& scene, const Rays<Real>& rays, const Light<Real>& light,
                                   Lanes<Real> distance, Mask<Real> wanted) {
    Indices<Real> own = -1;
    if (any(rays.inside & wanted)) {
        const Mask<Real> leaving = light.is_outside_of_own(rays, distance, wanted);
        own = select(leaving, rays.object, own);
        wanted &= ~leaving;
        if (!any(wanted)) {
            return own;
        }
    }
    OccluderQuery<Real, false> query(rays, light, distance, wanted);
    traverse(scene, rays, &light.view, query);
    Indices<Real> result = query.occluder;
    const Mask<Real> close = query.close & wanted;
    if (decides_ties<Real> && any(close)) [[unlikely]] {
        result = select(close, occluder_by_rules(scene, rays, light, distance, close), result);
    }
    return select(wanted, result, own);
}

}  // namespace whitted::WHITTED_ISA
