// The surface that rays have hit, as shading needs it.

#pragma once

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

}  // namespace whitted::WHITTED_ISA
