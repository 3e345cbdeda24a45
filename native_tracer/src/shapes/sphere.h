// The sphere. shapes.h says what a shape answers.

#pragma once

#include <cmath>
#include <limits>

#include "shapes/contact.h"
#include "shapes/crossing.h"
#include "shapes/sight.h"
#include "shapes/start.h"
#include "tracing/camera.h"
#include "tracing/description.h"
#include "tracing/incidence.h"
#include "tracing/ray.h"
#include "tracing/rounding.h"
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
        : center_(vector_of<Real>(sphere.center)),
          radius_(static_cast<Real>(sphere.radius)),
          error_(input_error(radius_) + input_error_of_point<Real>(sphere.center)),
          reach2_(radius_ * radius_ * (1 + 32 * std::numeric_limits<Real>::epsilon())),
          diameter_(2 * radius_),
          touching_(diameter_ * error_),
          most_touching_(most_of_radius<Real> * radius_ * radius_),
          object_(object),
          primitive_(first_primitive) {}

    int object() const { return object_; }
    int piece(int) const { return -1; }
    Real error_at(int, Real, const Vector<Real>&) const { return error_; }

    // With g = center - origin, the roots of t^2 - 2 (g.d) t + g.g - r^2 = 0. The discriminant is r^2 - |g - (g.d)
    // d|^2, which does not cancel for a small sphere far away, and the roots are q = g.d +- sqrt(...), of the sign that
    // adds, and (g.g - r^2) / q. Haines, Guenther and Akenine-Moller, "Precision Improvements for Ray/Sphere
    // Intersection", Ray Tracing Gems, 2019, ch. 7.
    template <bool which_primitive>
    [[gnu::always_inline]] bool intersect(const Rays<Real>& rays, const L&, Crossing<Real>& crossing,
                                          Mask<Real>&) const {
        const Vector<L> g = Vector<L>(center_) - rays.origin;
        const L closest = dot(g, rays.direction);  // where the ray passes the centre
        const Vector<L> across = g - closest * rays.direction;
        const L across2 = dot(across, across);
        const Mask<Real> near_enough = (across2 <= L(reach2_));
        if (!any(near_enough)) {
            return false;
        }
        const Mask<Real> starts_here = rays.object == Indices<Real>(object_);
        const Mask<Real> left_outward = starts_here & ~rays.inside;
        if (!any(near_enough & ~left_outward)) {
            return false;
        }

        Passage<Real> passage;
        pass(g, closest, across2, rays, starts_here, rays.inside, passage);
        crossing = first_crossing(passage, rays, starts_here & rays.inside);
        return true;
    }

    // The passage of rays through the sphere; those that start on it are inside it or not, as `start` knows.
    L pass(const Rays<Real>& rays, const Start<Real>& start, const Side* side, Passage<Real>& passage) const {
        const Vector<L> g = Vector<L>(center_) - rays.origin;
        const L closest = dot(g, rays.direction);
        const Vector<L> across = g - closest * rays.direction;
        const Mask<Real> here = start.on(*side);
        pass(g, closest, dot(across, across), rays, here, start.within(*side), passage);
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
        const Vector<L> g = Vector<L>(center_) - rays.origin;
        // Of a sphere smaller than such errors nothing is known.
        const L error = rays.t_min + L(error_);
        const Mask<Real> starts = (abs(length(g) - L(radius_)) <= error) &
                                  (error <= L(most_of_radius<Real>) * L(radius_)) &
                                  ~(rays.object == Indices<Real>(object_));
        const L through = L(2) * dot(g, rays.direction);
        const Mask<Real> crosses = (through > rays.t_min) & (crossing.t < infinity);
        crossing.t = select(starts, select(crosses, through, infinity), crossing.t);
        crossing.inside |= starts;
        return true;
    }

    int primitive_met(const Rays<Real>&, int, int primitive, Real, bool) const { return primitive; }

    Vector<Real> outward_at(int, const Vector<Real>& point) const { return normalize(point - center_); }

    SurfacePoint<Real> surface_at(int, const Vector<L>& near, const Rays<Real>& rays, Mask<Real> inside) const {
        const Vector<L> center(center_);
        const Vector<L> arm = near - center;
        const L length2 = dot(arm, arm);
        Vector<L> outward = arm * (L(Real(1)) / sqrt(length2));
        // Of a sphere that is too small beside the distance travelled, the point is the centre itself, or so near that
        // its square is 0. The normal may then be any that the ray can meet: it is taken along the ray.
        const Mask<Real> lost = length2 <= L(Real(0));
        if (any(lost)) [[unlikely]] {
            outward = select(lost, select(inside, rays.direction, -rays.direction), outward);
        }
        return {center + L(radius_) * outward, outward, error_, 1 / radius_};
    }

    template <typename Visit>
    void for_each_contact(const SphereDescription& sphere, const Triple& point, Visit visit) const {
        if (lies_on(sphere, point)) {
            const Vector<Real> arm = vector_of<Real>(in_range(direction(sphere.center, point)));
            visit(Contact<Real>{object_, primitive_, normalize(arm), 1 / radius_, false, true, primitive_});
        }
    }

 private:
    friend class SphereSight<Real>;

    [[gnu::always_inline]] void pass(const Vector<L>& g, L closest, L across2, const Rays<Real>& rays,
                                     Mask<Real> starts_here, Mask<Real> inside, Passage<Real>& passage) const {
        const L zero = Real(0);
        const L radius = radius_;
        const L radius2 = radius * radius;
        const L discriminant = radius2 - across2;
        // A ray that touches the sphere passes it by.
        const L touching =
            min(L(diameter_) * (rays.t_min + abs(closest) * rays.spread) + L(touching_), L(most_touching_));
        const L root = sqrt(max(discriminant, zero));
        const L q = closest + select(closest >= zero, root, -root);
        const L other = (dot(g, g) - radius2) / q;
        passage.near = min(q, other);
        passage.far = max(q, other);
        passage.near_primitive = primitive_;
        passage.far_primitive = primitive_;
        passage.misses = ~(discriminant > touching);
        if (any(starts_here)) {
            // With the origin on the sphere, the roots are 0 and 2 g.d, and only the second, from within, is a hit.
            const L through = closest + closest;
            passage.far = select(starts_here & inside, through, passage.far);
            passage.misses = select(starts_here, ~inside | (through <= zero), passage.misses);
        }
    }

    Vector<Real> center_;
    Real radius_;
    Real error_;   // how far the surface may be off
    Real reach2_;  // a line farther from the centre than its root misses, whatever was rounded
    Real diameter_;
    Real touching_, most_touching_;  // of a line that touches it, the discriminant for its error, and at most
    int object_, primitive_;
};

// A sphere as seen from a point.
template <typename Real>
class SphereSight : public BallInSight<Real> {
 public:
    using L = Lanes<Real>;
    using Ball = BallInSight<Real>;

    SphereSight(const Sphere<Real>& sphere, const Vector<Real>& point, Real extent)
        : Ball(sphere.center_, sphere.reach2_, point, extent),
          center_(sphere.center_),
          inside2_((1 - Ball::slack) * sphere.reach2_),
          encloses_((1 + Ball::slack) * Ball::larger(dot(Ball::to_center(), Ball::to_center()), extent) < inside2_) {}

    bool may_block(const Rays<Real>& rays, L distance, Mask<Real> wanted) const {
        if (encloses_) {
            const Vector<L> g = Vector<L>(center_) - rays.origin;
            return any(wanted & ~(dot(g, g) < L(inside2_)));
        }
        return Ball::may_block(rays, distance, wanted);
    }

 private:
    Vector<Real> center_;
    Real inside2_;   // r^2, and less by more than the error
    bool encloses_;  // the point lies in the sphere, and a ball holds all between two of its points
};

}  // namespace whitted::WHITTED_ISA
