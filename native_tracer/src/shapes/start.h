// What is known of where rays start on a shape of several parts.

#pragma once

#include "shapes/csg_plan.h"
#include "tracing/ray.h"
#include "tracing/vector.h"

namespace whitted::WHITTED_ISA {

// The surface that rays start on, and on which side of it they travel.
template <typename Real>
struct Start {
    bool any = false;  // some ray starts on one
    Mask<Real> here = Mask<Real>::none();
    Indices<Real> primitive = -1;
    Indices<Real> surface = -1;
    Mask<Real> inner = Mask<Real>::none();

    // Which rays start on a primitive's surface, and which of all are then on the primitive's inner side.
    Mask<Real> on(const Side& side) const {
        return any ? here & (surface == Indices<Real>(side.surface)) : Mask<Real>::none();
    }
    Mask<Real> within(const Side& side) const { return side.reversed ? ~inner : inner; }
};

}  // namespace whitted::WHITTED_ISA
