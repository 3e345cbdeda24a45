// Where rays turn at a surface: mirrored, refracted, and spread about these directions.

#pragma once

#include "tracing/hits.h"
#include "tracing/ray.h"
#include "tracing/rounding.h"
#include "tracing/sampler.h"
#include "tracing/surface.h"
#include "tracing/vector.h"

namespace whitted::WHITTED_ISA {

// Where secondary rays lead, how far their directions may be off, and whether they travel inside.
template <typename Real>
struct Turn {
    Vector<Lanes<Real>> direction;
    Lanes<Real> spread;
    Mask<Real> inside;
};

// `cosine` is that of the angle of incidence.
template <typename Real>
Turn<Real> mirror(const Rays<Real>& rays, const Hits<Real>& hits, const Surface<Real>& surface, Lanes<Real> cosine) {
    using L = Lanes<Real>;
    return {normalize(rays.direction + L(2) * cosine * surface.normal),
            min(rays.spread + L(2) * surface.lean + L(least_spread<Real>), L(most_blur<Real>)), hits.inside};
}

// Snell's law, with the ratio of the index on the ray's side to the index on the other: n1/n2 on the way in, n2/n1 on
// the way out. Where it has no answer, which `total` tells, the ray follows the mirror direction.
template <typename Real>
Turn<Real> refract(const Rays<Real>& rays, const Hits<Real>& hits, const Surface<Real>& surface, Lanes<Real> cosine,
                   const Turn<Real>& mirrored, Mask<Real>& total) {
    using L = Lanes<Real>;
    const L zero = Real(0);
    const L one = Real(1);
    const L eta = select(hits.inside, one / surface.eta, surface.eta);
    // 1 - eta^2 (1 - cosine^2), without the difference of nearly equal numbers where eta is nearly 1. Where it is 0 but
    // for its error the ray is refracted along the surface.
    const L exact_cosine2 = (one - eta) * (one + eta) + eta * cosine * (eta * cosine);
    const L cosine_error = min(rays.spread + surface.lean, L(most_blur<Real>));
    const L rounding = L(4 * tie_epsilon<Real>);
    const L critical = eta * eta * (L(2) * cosine * cosine_error + rounding) + rounding;
    const L cosine2 = select(abs(exact_cosine2) <= critical, zero, exact_cosine2);
    const Vector<L> refracted = eta * rays.direction + (eta * cosine - sqrt(max(cosine2, zero))) * surface.normal;
    const L length2 = dot(refracted, refracted);
    // Of a ratio beyond all measure these may be NaN, or 0.
    total = ~((cosine2 >= zero) & (length2 > zero));
    // In the plane of incidence it is more near the critical angle; across it, it is not.
    const L steepest = L(2) * (one + eta);
    const L spread = min(cosine_error * steepest + L(least_spread<Real>), L(most_blur<Real>));
    return {select(total, mirrored.direction, refracted * (one / sqrt(length2))),
            select(total, mirrored.spread, spread), select(total, hits.inside, ~hits.inside)};
}

// Directions that are uniform in the cone about those of `turn`, at points of the unit square. Those that lead to the
// other side of the surface's tangent plane are mirrored in that. `versine` is 1 - cos(half-angle), 0 where there is
// no cone.
template <typename Real>
void spread_in_cone(const Surface<Real>& surface, Lanes<Real> versine, const PlanePoint<Real>& square,
                    Turn<Real>& turn) {
    using L = Lanes<Real>;
    const L zero = Real(0);
    const Mask<Real> spreads = versine > zero;
    const Vector<L> direction = cone_direction(Frame<Real>(turn.direction), versine, square.x, square.y);
    const Vector<L> normal = select(turn.inside, -surface.outward, surface.outward);
    const L below = min(dot(normal, direction), zero);
    turn.direction = select(spreads, normalize(direction - (L(2) * below) * normal), turn.direction);
    // By eight times at most do the frame's axes turn faster than its axis.
    const L spread = L(8) * turn.spread + L(2) * surface.lean;
    turn.spread = select(spreads, min(spread, L(most_blur<Real>)), turn.spread);
}

}  // namespace whitted::WHITTED_ISA
