// Lights, and what is known of rays that lead to one before any is traced.

#pragma once

#include <cstddef>
#include <vector>

#include "shapes/contact.h"
#include "shapes/crossing.h"
#include "shapes/shapes.h"
#include "tracing/ray.h"
#include "tracing/vector.h"

namespace whitted::WHITTED_ISA {

template <typename Real>
struct Light {
    using L = Lanes<Real>;
    Vector<Real> position;
    Color<Real> color;
    Real a, b, c;  // dimmed by 1 / (a + b d + c d^2) at distance d
    Real radius;   // of a disc that faces the point being lit
    Real error;    // how far the position's sums with others may be off
    View<Real> view;
    std::vector<Contact<Real>> contacts;  // of a light that is a point
    std::vector<Real> outside{};          // of each polyhedron or csg: how far the light surely lies outside

    bool is_point() const { return radius == 0; }

    // Whether rays that lead to the light start within a polyhedron or a csg that it lies outside of: they cross its
    // surface, wherever that may be. Only where no rounding can matter: some plane, of the body or of the box around
    // it, is crossed far from the light, and steeply.
    Mask<Real> is_outside_of_own(const Rays<Real>& rays, L distance, Mask<Real> wanted) const {
        const Mask<Real> within = rays.inside & wanted;  // the others may start on nothing
        const L height = L::gather(
            [&](int lane) { return within[lane] ? outside[static_cast<std::size_t>(rays.object[lane])] : Real(0); });
        return height > L(Real(0x1p-10)) * distance;
    }

    // Whether rays that lead to the light cross an object at the surface that the light lies on.
    Mask<Real> lies_at(const Crossing<Real>& crossing, const Vector<L>& direction) const {
        Mask<Real> result = Mask<Real>::none();
        for (const Contact<Real>& contact : contacts) {
            result |= contact.is_at(crossing, direction);
        }
        return result;
    }

    // Whether the light lies in the plane of these primitives, and so shines along them.
    Mask<Real> grazes(Indices<Real> primitive) const {
        Mask<Real> result = Mask<Real>::none();
        for (const Contact<Real>& contact : contacts) {
            if (contact.flat) {
                result |= primitive == Indices<Real>(contact.primitive);
            }
        }
        return result;
    }
};

}  // namespace whitted::WHITTED_ISA
