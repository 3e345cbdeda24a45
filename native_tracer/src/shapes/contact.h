// What the eye or a light lies on.

#pragma once

#include <vector>

#include "shapes/crossing.h"
#include "tracing/ray.h"
#include "tracing/vector.h"

namespace whitted::WHITTED_ISA {

// By its columns.
template <typename Real>
struct Matrix {
    Vector<Real> x{}, y{}, z{};
};

// A primitive that a point lies on.
template <typename Real>
struct Contact {
    int object, primitive;
    Vector<Real> outward;  // the surface's unit normal there
    Real curvature;        // by how much that turns along a unit of length, at most
    Matrix<Real> turn;     // what that turns by along a unit of length on each axis, but for what is along itself
    bool flat;             // it is part of a plane
    bool on_body;          // the point lies on the object, and not only in the plane of a face beside the face
    int body;              // the first primitive of the convex shape, or the quadric, that this is part of; -1: none

    // Whether rays that lead to the point cross the object there, and no sooner: a plane wherever they do; of a surface
    // that they meet twice, once from without and once from within, it is the place of the same kind.
    Mask<Real> is_at(const Crossing<Real>& crossing, const Vector<Lanes<Real>>& direction) const {
        const Mask<Real> from_without = dot(Vector<Lanes<Real>>(outward), direction) < Lanes<Real>(Real(0));
        return (crossing.primitive == Indices<Real>(primitive)) & (from_without ^ crossing.inside);
    }
};

// What rays from the eye start on, as rays that leave a surface do. Of several objects that the eye lies on it is the
// first.
template <typename Real>
struct EyeContact {
    int object = -1, primitive = -1, body = -1;
    std::vector<Vector<Real>> outward;  // of all the body's primitives that the eye lies on
    Real curvature = 0;
    Matrix<Real> turn;

    // Rays along a plane, too, or along a straight line in a quadric, for a body is closed, and those that touch from
    // within what is hollow; not those that touch a sphere. Eye and directions may be off.
    Mask<Real> leads_inside(const Vector<Lanes<Real>>& direction, Real eye_error, Real spread) const {
        using L = Lanes<Real>;
        const L bound = spread + curvature * eye_error;
        const Vector<L> turned =
            direction.x * Vector<L>(turn.x) + direction.y * Vector<L>(turn.y) + direction.z * Vector<L>(turn.z);
        const Mask<Real> bends_away = dot(turned, direction) > L(4 * curvature * spread);
        Mask<Real> result = outward.empty() ? Mask<Real>::none() : ~Mask<Real>::none();
        for (const Vector<Real>& normal : outward) {
            result &= dot(Vector<L>(normal), direction) < select(bends_away, -bound, bound);
        }
        return result;
    }
};

}  // namespace whitted::WHITTED_ISA
