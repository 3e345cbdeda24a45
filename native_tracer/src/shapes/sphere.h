// The sphere. shapes.h says what a shape answers.

#pragma once

#include <cmath>
#include <limits>

#include "shapes/ball.h"
#include "shapes/contact.h"
#include "shapes/crossing.h"
#include "shapes/sight.h"
#include "shapes/start.h"
#include "tracing/description.h"
#include "tracing/incidence.h"
#include "tracing/ray.h"
#include "tracing/rounding.h"
#include "tracing/triple.h"
#include "tracing/vector.h"

namespace whitted::WHITTED_ISA {

template <typename Real>
class SphereSight;

template <typename Real>
class Sphere {
 public:
    using L = Lanes<Real>;
    using Description = SphereDescription;
    using Sight = SphereSight<Real>;

    static int primitive_count(const SphereDescription&) { return 1; }

    Sphere(const SphereDescription& sphere, int object, int first_primitive)
        : ball_(vector_of<Real>(sphere.center), static_cast<Real>(sphere.radius),
                input_error(static_cast<Real>(sphere.radius)) + input_error_of_point<Real>(sphere.center), object,
                first_primitive) {}

    const Ball<Real, Real, int>& ball() const { return ball_; }
    int object() const { return ball_.object(); }
    int piece(int) const { return -1; }
    Real error_at(int, Real, const Vector<Real>&) const { return ball_.error(); }

    template <bool which_primitive>
    [[gnu::always_inline]] bool intersect(const Rays<Real>& rays, const L&, Crossing<Real>& crossing,
                                          Mask<Real>&) const {
        return ball_.intersect(rays, crossing);
    }

    // The passage of rays through the sphere; those that start on it are inside it or not, as `start` knows.
    L pass(const Rays<Real>& rays, const Start<Real>& start, const Side* side, Passage<Real>& passage) const {
        const Vector<L> g = Vector<L>(ball_.center()) - rays.origin;
        const L closest = dot(g, rays.direction);
        const Vector<L> across = g - closest * rays.direction;
        const Mask<Real> here = start.on(*side);
        ball_.pass(g, closest, dot(across, across), rays, here, start.within(*side), passage);
        passage.near = select(here, L(-std::numeric_limits<Real>::infinity()), passage.near);
        return std::numeric_limits<Real>::infinity();
    }

    // Rays that start on the sphere by the roundings of their origins only, and not by knowledge, do not meet it there.
    bool intersect_by_rules(const Rays<Real>& rays, Crossing<Real>& crossing) const {
        Mask<Real> unused = Mask<Real>::none();
        if (!intersect<true>(rays, rays.t_min, crossing, unused)) {
            return false;
        }
        const L infinity = std::numeric_limits<Real>::infinity();
        const Vector<L> g = Vector<L>(ball_.center()) - rays.origin;
        // Of a sphere smaller than such errors nothing is known.
        const L error = rays.t_min + L(ball_.error());
        const Mask<Real> starts = (abs(length(g) - L(ball_.radius())) <= error) &
                                  (error <= L(most_of_radius<Real>) * L(ball_.radius())) &
                                  ~(rays.object == Indices<Real>(ball_.object()));
        const L through = L(2) * dot(g, rays.direction);
        const Mask<Real> crosses = (through > rays.t_min) & (crossing.t < infinity);
        crossing.t = select(starts, select(crosses, through, infinity), crossing.t);
        crossing.inside |= starts;
        return true;
    }

    int primitive_met(const Rays<Real>&, int, int primitive, Real, bool) const { return primitive; }

    Vector<Real> outward_at(int, const Vector<Real>& point) const { return normalize(point - ball_.center()); }

    SurfacePoint<Real> surface_at(int, const Vector<L>& near, const Rays<Real>& rays, Mask<Real> inside) const {
        const Vector<L> center(ball_.center());
        const Vector<L> arm = near - center;
        const L length2 = dot(arm, arm);
        Vector<L> outward = arm * (L(Real(1)) / sqrt(length2));
        // Of a sphere that is too small beside the distance travelled, the point is the centre itself, or so near that
        // its square is 0. The normal may then be any that the ray can meet: it is taken along the ray.
        const Mask<Real> lost = length2 <= L(Real(0));
        if (any(lost)) [[unlikely]] {
            outward = select(lost, select(inside, rays.direction, -rays.direction), outward);
        }
        return {center + L(ball_.radius()) * outward, outward, ball_.error(), 1 / ball_.radius()};
    }

    template <typename Visit>
    void for_each_contact(const SphereDescription& sphere, const Triple& point, Visit visit) const {
        if (lies_on(sphere, point)) {
            const Vector<Real> arm = vector_of<Real>(in_range(direction(sphere.center, point)));
            const Real bend = 1 / ball_.radius();
            visit(Contact<Real>{ball_.object(),
                                ball_.primitive(),
                                normalize(arm),
                                bend,
                                {{bend, 0, 0}, {0, bend, 0}, {0, 0, bend}},
                                false,
                                true,
                                ball_.primitive()});
        }
    }

 private:
    Ball<Real, Real, int> ball_;
};

// A sphere as seen from a point.
template <typename Real>
class SphereSight : public BallInSight<Real> {
 public:
    using L = Lanes<Real>;
    using InSight = BallInSight<Real>;

    SphereSight(const Sphere<Real>& sphere, const Vector<Real>& point, Real extent)
        : InSight(sphere.ball().center(), sphere.ball().reach2(), point, extent),
          center_(sphere.ball().center()),
          inside2_((1 - InSight::slack) * sphere.ball().reach2()),
          encloses_((1 + InSight::slack) * InSight::larger(dot(InSight::to_center(), InSight::to_center()), extent) <
                    inside2_) {}

    bool may_block(const Rays<Real>& rays, L distance, Mask<Real> wanted) const {
        if (encloses_) {
            const Vector<L> g = Vector<L>(center_) - rays.origin;
            return any(wanted & ~(dot(g, g) < L(inside2_)));
        }
        return InSight::may_block(rays, distance, wanted);
    }

 private:
    Vector<Real> center_;
    Real inside2_;   // r^2, and less by more than the error
    bool encloses_;  // the point lies in the sphere, and a ball holds all between two of its points
};

}  // namespace whitted::WHITTED_ISA
