// A shape that moves: any of the others, at its place plus a ray's time times a displacement. shapes.h says what a
// shape answers.
//
// Whether a ray meets it is asked where it stands still: the ray is brought there instead, see at_rest(), and the
// answer holds where the ray is, for distances and directions are the same. So a moving shape answers what its body
// does, and what is known of where rays start holds too.

#pragma once

#include <algorithm>

#include "shapes/contact.h"
#include "shapes/convex_polyhedron.h"
#include "shapes/crossing.h"
#include "shapes/csg.h"
#include "shapes/quadric.h"
#include "shapes/shape_lists.h"
#include "shapes/sight.h"
#include "shapes/sphere.h"
#include "tracing/description.h"
#include "tracing/incidence.h"
#include "tracing/ray.h"
#include "tracing/rounding.h"
#include "tracing/triple.h"
#include "tracing/vector.h"

namespace whitted::WHITTED_ISA {

template <typename Real>
class Moving {
 public:
    using L = Lanes<Real>;
    using Description = MovingDescription;
    using Sight = AlwaysInSight<Real>;
    using Bodies = ShapeLists<Real, Sphere<Real>, ConvexPolyhedron<Real>, Quadric<Real>, Csg<Real>>;

    static int primitive_count(const MovingDescription& moving) { return Bodies::primitive_count(moving.body); }

    [[gnu::noinline]] Moving(const MovingDescription& moving, int object, int first_primitive)
        : displacement_(vector_of<Real>(moving.displacement)),
          error_(input_error_of_point<Real>(moving.displacement)),
          object_(object),
          body_(bodies_.add(moving.body, object, first_primitive)) {}

    // The rays as they meet the body where it stands still.
    [[gnu::noinline]] Rays<Real> bring_back(const Rays<Real>& rays) const {
        const Vector<L> way = way_at(rays.time);
        Rays<Real> result = rays;
        result.origin = rays.origin - way;
        result.t_min = rays.t_min + error_of(rays.reach, way);
        result.reach = max_norm(result.origin);
        return result;
    }

    // Takes points on the body to where it is, and adds to how far they may be off.
    void take_along(L time, Vector<L>& point, L& error) const {
        const Vector<L> way = way_at(time);
        error = error + error_of(max_norm(point), way);
        point = point + way;
    }

    int object() const { return object_; }
    [[gnu::noinline]] int piece(int primitive) const {
        return bodies_.visit(body_, [&](const auto& body) { return body.piece(primitive); });
    }
    [[gnu::noinline]] Real error_at(int primitive, Real reach, const Vector<Real>& point) const {
        return bodies_.visit(body_, [&](const auto& body) { return body.error_at(primitive, reach, point); });
    }

    template <bool which_primitive>
    [[gnu::noinline]] bool intersect(const Rays<Real>& rays, const L& limit, Crossing<Real>& crossing,
                                     Mask<Real>& close) const {
        return bodies_.visit(body_, [&](const auto& body) {
            return body.template intersect<which_primitive>(rays, limit, crossing, close);
        });
    }
    [[gnu::noinline]] bool intersect_by_rules(const Rays<Real>& rays, Crossing<Real>& crossing) const {
        return bodies_.visit(body_, [&](const auto& body) { return body.intersect_by_rules(rays, crossing); });
    }
    [[gnu::noinline]] int primitive_met(const Rays<Real>& rays, int lane, int hit, Real t, bool inside) const {
        return bodies_.visit(body_, [&](const auto& body) { return body.primitive_met(rays, lane, hit, t, inside); });
    }

    [[gnu::noinline]] Vector<Real> outward_at(int primitive, const Vector<Real>& point) const {
        return bodies_.visit(body_, [&](const auto& body) { return body.outward_at(primitive, point); });
    }
    [[gnu::noinline]] SurfacePoint<Real> surface_at(int primitive, const Vector<L>& near, const Rays<Real>& rays,
                                                    Mask<Real> inside) const {
        return bodies_.visit(body_, [&](const auto& body) { return body.surface_at(primitive, near, rays, inside); });
    }

    // Those of every time: with primitives that slide in themselves. Which of them are on the body changes, and is not
    // said.
    template <typename Visit>
    void for_each_contact(const MovingDescription& moving, const Triple& point, Visit visit) const {
        bodies_.visit(body_, moving.body, [&](const auto& body, const auto& description) {
            body.for_each_contact(description, point, [&](Contact<Real> contact) {
                if (slides(description, piece_of(body, contact.primitive), moving.displacement)) {
                    contact.on_body = false;
                    contact.body = -1;
                    visit(contact);
                }
            });
        });
    }

 private:
    // That there is only one has a name of its own.
    template <typename Body>
    static int piece_of(const Body& body, int primitive) {
        return std::max(body.piece(primitive), 0);
    }

    Vector<L> way_at(L time) const { return time * Vector<L>(displacement_); }

    // Of a sum or a difference of a point and a way.
    L error_of(L reach, const Vector<L>& way) const {
        return L(2 * input_epsilon<Real>) * (reach + max_norm(way)) + L(error_);
    }

    Vector<Real> displacement_;
    Real error_;  // how far it may be off
    int object_;
    Bodies bodies_;  // one
    ShapeIndex body_;
};

extern template class Moving<float>;  // in shapes.cpp
extern template class Moving<double>;

// Rays as a shape answers them: where it stands still.
template <typename Shape, typename Real>
[[gnu::always_inline]] inline const Rays<Real>& at_rest(const Shape&, const Rays<Real>& rays) {
    return rays;
}
template <typename Real>
Rays<Real> at_rest(const Moving<Real>& shape, const Rays<Real>& rays) {
    return shape.bring_back(rays);
}

}  // namespace whitted::WHITTED_ISA
