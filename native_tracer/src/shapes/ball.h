// What a sphere is made of, and where rays meet it: one sphere that all rays of a group may meet, or one to a lane.
// Either way it is the same arithmetic, in the same order.

#pragma once

#include <algorithm>
#include <bit>
#include <limits>

#include "shapes/crossing.h"
#include "tracing/ray.h"
#include "tracing/rounding.h"
#include "tracing/vector.h"

namespace whitted::WHITTED_ISA {

// `Number` is Real or Lanes<Real>, `Integer` int or Indices<Real>.
template <typename Real, typename Number, typename Integer>
class Ball {
 public:
    using L = Lanes<Real>;

    Ball(const Vector<Number>& center, Number radius, Number error, Integer object, Integer primitive)
        : center_(center),
          radius_(radius),
          error_(error),
          reach2_(radius * radius * Number(1 + 32 * std::numeric_limits<Real>::epsilon())),
          diameter_(Number(2) * radius),
          touching_(diameter_ * error),
          most_touching_(Number(most_of_radius<Real>) * radius * radius),
          object_(object),
          primitive_(primitive) {}

    const Vector<Number>& center() const { return center_; }
    Number radius() const { return radius_; }
    Number error() const { return error_; }  // how far the surface may be off
    Number reach2() const {
        return reach2_;
    }  // a line farther from the centre than its root misses, whatever was rounded
    Integer object() const { return object_; }
    Integer primitive() const { return primitive_; }

    // With g = center - origin, the roots of t^2 - 2 (g.d) t + g.g - r^2 = 0. The discriminant is r^2 - |g - (g.d)
    // d|^2, which does not cancel for a small sphere far away, and the roots are q = g.d +- sqrt(...), of the sign that
    // adds, and (g.g - r^2) / q. Haines, Guenther and Akenine-Moller, "Precision Improvements for Ray/Sphere
    // Intersection", Ray Tracing Gems, 2019, ch. 7.
    [[gnu::always_inline]] bool intersect(const Rays<Real>& rays, Crossing<Real>& crossing) const {
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

    // The passage of rays that pass the centre at the distance `closest`, apart from it by `across`, squared.
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

 private:
    Vector<Number> center_;
    Number radius_, error_, reach2_;
    Number diameter_;
    Number touching_, most_touching_;  // of a line that touches it, the discriminant for its error, and at most
    Integer object_, primitive_;
};

// Some lanes' spheres: ball_of(lane) for those with a bit in `lanes`. No ray meets those of others.
template <typename Real, typename BallOf>
[[gnu::always_inline]] inline Ball<Real, Lanes<Real>, Indices<Real>> gather_balls(unsigned lanes, BallOf ball_of) {
    constexpr int count = lane_count<Real>;
    Real numbers[5][count];
    typename Indices<Real>::Integer objects[count], primitives[count] = {};
    std::fill_n(numbers[3], count, std::numeric_limits<Real>::quiet_NaN());
    std::fill_n(objects, count, -2);  // which no ray starts on, not even one that starts on nothing
    for (; lanes != 0; lanes &= lanes - 1) {
        const int lane = std::countr_zero(lanes);
        const Ball<Real, Real, int>& ball = ball_of(lane);
        numbers[0][lane] = ball.center().x;
        numbers[1][lane] = ball.center().y;
        numbers[2][lane] = ball.center().z;
        numbers[3][lane] = ball.radius();
        numbers[4][lane] = ball.error();
        objects[lane] = ball.object();
        primitives[lane] = ball.primitive();
    }
    Vector<Lanes<Real>> center;
    Lanes<Real> radius, error;
    Indices<Real> object, primitive;
    load(numbers[0], center.x);
    load(numbers[1], center.y);
    load(numbers[2], center.z);
    load(numbers[3], radius);
    load(numbers[4], error);
    load(objects, object);
    load(primitives, primitive);
    return {center, radius, error, object, primitive};
}

}  // namespace whitted::WHITTED_ISA
