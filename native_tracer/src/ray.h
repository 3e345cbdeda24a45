// Rays: in groups, one to a lane, as they are traced, and one by one, as they wait for it.

#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>

#include "vector.h"

namespace whitted::WHITTED_ISA {

template <typename Real>
struct Rays {
    Vector<Lanes<Real>> origin, direction;  // directions are unit vectors
    Lanes<Real> t_min;                      // a hit on anything but `object` counts when it is farther
    Indices<Real> object, patch;            // what the ray starts on; -1: nothing
    Mask<Real> inside;                      // it travels inside `object`
};

// A bound of the rounding error of points found at distance t of their rays. Some thirty operations on numbers of about
// that size lead to a coordinate, each wrong by half an epsilon at most; 32 epsilon is twice their sum.
template <typename Real>
Lanes<Real> rounding_error(const Vector<Lanes<Real>>& point, Lanes<Real> t) {
    return Lanes<Real>(32 * std::numeric_limits<Real>::epsilon()) * (max_norm(point) + t);
}

// A ray that waits for its turn.
template <typename Real>
struct PendingRay {
    Vector<Real> origin, direction;
    Real t_min;
    Real weight;        // what its colour counts for in its pixel
    int object, patch;  // what it starts on; -1: nothing
    int depth;          // bounces before it
    int pixel;
    int record;  // what the observer knows it by
    bool inside;

    PendingRay() {}  // undefined, for all of it is set at once
};

// A group of rays that are traced together. Lanes from `count` on hold no ray of their own, and nobody looks at them.
template <typename Real>
struct Group {
    static constexpr int lanes = lane_count<Real>;

    Rays<Real> rays;
    Lanes<Real> weight;
    Mask<Real> active;
    int count;
    Indices<Real> depth;
    int pixel[lanes], record[lanes];

    // The first of `available` rays, as many as there are lanes; lanes without a ray repeat the last one.
    void take(const PendingRay<Real>* pending, std::size_t available) {
        count = static_cast<int>(std::min<std::size_t>(available, lanes));
        const PendingRay<Real>* of[lanes];
        for (int lane = 0; lane < lanes; ++lane) {
            of[lane] = pending + std::min(lane, count - 1);
            pixel[lane] = of[lane]->pixel;
            record[lane] = of[lane]->record;
        }
        rays.origin = gather<Real>([&](int lane) { return of[lane]->origin; });
        rays.direction = gather<Real>([&](int lane) { return of[lane]->direction; });
        rays.t_min = Lanes<Real>::gather([&](int lane) { return of[lane]->t_min; });
        rays.object = Indices<Real>::gather([&](int lane) { return of[lane]->object; });
        rays.patch = Indices<Real>::gather([&](int lane) { return of[lane]->patch; });
        rays.inside = Mask<Real>::gather([&](int lane) { return of[lane]->inside; });
        depth = Indices<Real>::gather([&](int lane) { return of[lane]->depth; });
        weight = Lanes<Real>::gather([&](int lane) { return of[lane]->weight; });
        active = Mask<Real>::first(count);
    }
};

}  // namespace whitted::WHITTED_ISA
