// What rays have hit.

#pragma once

#include <limits>

#include "tracing/vector.h"

namespace whitted::WHITTED_ISA {

template <typename Real>
struct Hits {
    Lanes<Real> t = std::numeric_limits<Real>::infinity();
    Indices<Real> object = -1;  // -1: nothing is hit
    Indices<Real> primitive = -1;
    Mask<Real> inside = Mask<Real>::none();

    // Takes the hits of the rays that the mask names from `other`.
    [[gnu::always_inline]] void put(Mask<Real> named, const Hits& other) {
        t = select(named, other.t, t);
        object = select(named, other.object, object);
        primitive = select(named, other.primitive, primitive);
        inside = select(named, other.inside, inside);
    }
};

}  // namespace whitted::WHITTED_ISA
