// The quadric: the points where a polynomial of the second degree is not above 0. shapes.h says what a shape answers.

#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "shapes/canonical_form.h"
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

// With x = the point in the axes of the canonical form, Q(x) = x.Bx + 2 l.x + k; half its gradient is Bx + l. B is
// diagonal, and kept as a vector.
template <typename Real>
class Quadric {
 public:
    using L = Lanes<Real>;
    using Description = QuadricDescription;
    using Sight = BallInSight<Real>;

    static int primitive_count(const QuadricDescription&) { return 1; }

    [[gnu::noinline]] Quadric(const QuadricDescription& quadric, int object, int first_primitive)
        : Quadric(canonical_form(quadric), quadric, object, first_primitive) {}

    int object() const { return object_; }
    int piece(int) const { return -1; }

    // A ball that holds the surface, for its sight.
    const Vector<Real>& ball_center() const { return center_; }
    Real ball_reach2() const { return ball_reach2_; }

    Real error_at(int, Real reach, const Vector<Real>& point) const {
        return error_of(reach, length(half_gradient(local<Real>(point))));
    }

    // The passage of rays through the quadric; those that start on it are inside it or not, as `start` knows.
    L pass(const Rays<Real>& rays, const Start<Real>& start, const Side* side, Passage<Real>& passage) const {
        pass(equation_along(rays), rays, start.on(*side), start.within(*side), passage);
        return std::numeric_limits<Real>::infinity();
    }

    template <bool which_primitive>
    [[gnu::always_inline]] bool intersect(const Rays<Real>& rays, const L&, Crossing<Real>& crossing,
                                          Mask<Real>&) const {
        return intersect(rays, crossing);
    }

    // Rays that start on the surface by the roundings of their origins only, and not by knowledge, do not meet it
    // there.
    [[gnu::noinline]] bool intersect_by_rules(const Rays<Real>& rays, Crossing<Real>& crossing) const {
        if (!intersect(rays, crossing)) {
            return false;
        }
        const L infinity = std::numeric_limits<Real>::infinity();
        const Equation equation = equation_along(rays);
        const L gradient = length(equation.half_gradient);
        const L error = rays.t_min + error_of(rays.reach, gradient);
        // Of one that bends more than such errors tell, nothing is known.
        const Mask<Real> starts = (abs(equation.c) <= L(2) * gradient * error) &
                                  (L(most_bend_) * error <= L(most_of_radius<Real>) * gradient) &
                                  ~(rays.object == Indices<Real>(object_));
        const L through = equation.other_end();
        const Mask<Real> crosses = (through > rays.t_min) & (through < infinity) & (crossing.t < infinity);
        crossing.t = select(starts, select(crosses, through, infinity), crossing.t);
        crossing.inside = select(starts, equation.a > L(Real(0)), crossing.inside);
        return true;
    }

    int primitive_met(const Rays<Real>&, int, int primitive, Real, bool) const { return primitive; }

    [[gnu::noinline]] Vector<Real> outward_at(int, const Vector<Real>& point) const {
        return normalize(to_space(half_gradient(local<Real>(point))));
    }

    // By two of Newton's steps along the gradient.
    [[gnu::noinline]] SurfacePoint<Real> surface_at(int, const Vector<L>& near, const Rays<Real>& rays,
                                                    Mask<Real> inside) const {
        Vector<L> x = local<L>(near);
        // At a cone's tip there is no gradient, and near it that may be too small for a step.
        const L farthest = L(std::sqrt(std::numeric_limits<Real>::epsilon())) * (max_norm(near) + rays.reach);
        for (int step = 0; step < 2; ++step) {
            const Vector<L> g = half_gradient(x);
            const L value = dot(x, g) + dot(x, Vector<L>(linear_)) + L(constant_);
            const Vector<L> moved = (value / (L(2) * dot(g, g))) * g;
            x = select(max_norm(moved) <= farthest, x - moved, x);
        }
        const Vector<L> gradient = half_gradient(x);
        const L size = length(gradient);
        Vector<L> outward = to_space(gradient * (L(Real(1)) / size));
        const Mask<Real> lost = ~(size > L(Real(0)));
        if (any(lost)) [[unlikely]] {
            outward = select(lost, select(inside, rays.direction, -rays.direction), outward);
        }
        const L size_or_1 = select(lost, L(Real(1)), size);
        return {Vector<L>(center_) + to_space(x), outward, error_of(rays.reach, size_or_1), L(most_bend_) / size_or_1};
    }

    template <typename Visit>
    void for_each_contact(const QuadricDescription& quadric, const Triple& point, Visit visit) const {
        if (!lies_on(quadric, point)) {
            return;
        }
        const Vector<Real> gradient = half_gradient(local<Real>(vector_of<Real>(point)));
        const Real size = length(gradient);
        if (size > 0) {
            const auto turn = [&](const Vector<Real>& axis) { return to_space(bend_ * to_axes(axis)) / size; };
            visit(Contact<Real>{object_,
                                primitive_,
                                to_space(gradient) / size,
                                most_bend_ / size,
                                {turn({1, 0, 0}), turn({0, 1, 0}), turn({0, 0, 1})},
                                false,
                                true,
                                primitive_});
        }
    }

 private:
    // a t^2 + 2 b t + c along rays, and what it is made of. c is 0 at the origin of rays that start on the quadric.
    struct Equation {
        L a, b, c;
        L discriminant;           // b^2 - a c
        Vector<L> half_gradient;  // at the origin
        Vector<L> bent_direction;

        // With c = 0 one root is 0, and this is the other: NaN, or infinite, if there is none.
        L other_end() const { return -(b + b) / a; }
    };

    Quadric(const CanonicalForm& form, const QuadricDescription& quadric, int object, int first_primitive)
        : center_(rounded(form.center)),
          bend_(rounded(form.bend)),
          linear_(rounded(form.linear)),
          minors_(rounded({form.bend[1] * form.bend[2], form.bend[0] * form.bend[2], form.bend[0] * form.bend[1]})),
          constant_(static_cast<Real>(form.constant)),
          has_center_(linear_.x == 0 && linear_.y == 0 && linear_.z == 0),
          turned_(form.turned),
          most_bend_(std::max({std::abs(bend_.x), std::abs(bend_.y), std::abs(bend_.z)})),
          object_(object),
          primitive_(first_primitive) {
        for (std::size_t k = 0; k < 3; ++k) {
            axes_[k] = rounded({form.axes[0][k], form.axes[1][k], form.axes[2][k]});
            rows_[k] = rounded(form.axes[k]);
        }
        center_error_ = std::max({input_error(center_.x), input_error(center_.y), input_error(center_.z)});
        const auto error_of_term = [&](std::size_t i) {
            return static_cast<Real>(form.scale) * input_error(static_cast<Real>(quadric.coefficients[i]));
        };
        for (std::size_t i = 0; i < 10; ++i) {
            (i < 6 ? second_error_ : i < 9 ? first_error_ : zeroth_error_) += error_of_term(i);
        }
        find_ball(form);
    }

    // Out of line, for others' sake: it is long.
    [[gnu::noinline]] bool intersect(const Rays<Real>& rays, Crossing<Real>& crossing) const {
        const Mask<Real> start = rays.object == Indices<Real>(object_);
        const Equation equation = equation_along(rays);
        if (!any(equation.discriminant > L(Real(0)))) {
            return false;
        }
        Passage<Real> passage;
        pass(equation, rays, start, rays.inside, passage);
        crossing = first_crossing(passage, rays, start);
        crossing.inside = crossing.inside ^ passage.inverted;
        return true;
    }

    static Vector<Real> rounded(const std::array<long double, 3>& v) {
        return {static_cast<Real>(v[0]), static_cast<Real>(v[1]), static_cast<Real>(v[2])};
    }

    // The ball about the centre that holds the surface of an ellipsoid.
    void find_ball(const CanonicalForm& form) {
        ball_reach2_ = std::numeric_limits<Real>::infinity();
        const bool all_ways = form.bend[0] * form.bend[1] > 0 && form.bend[0] * form.bend[2] > 0;
        if (has_center_ && all_ways) {
            const long double least =
                std::min({std::abs(form.bend[0]), std::abs(form.bend[1]), std::abs(form.bend[2])});
            const auto error = static_cast<long double>(1024 * std::numeric_limits<Real>::epsilon());
            ball_reach2_ = static_cast<Real>((1 + error) * std::abs(form.constant) / least);
        }
    }

    template <typename T>
    Vector<T> to_axes(const Vector<T>& v) const {
        if (!turned_) {
            return v;
        }
        return {dot(Vector<T>(axes_[0]), v), dot(Vector<T>(axes_[1]), v), dot(Vector<T>(axes_[2]), v)};
    }
    template <typename T>
    Vector<T> to_space(const Vector<T>& v) const {
        if (!turned_) {
            return v;
        }
        return {dot(Vector<T>(rows_[0]), v), dot(Vector<T>(rows_[1]), v), dot(Vector<T>(rows_[2]), v)};
    }
    template <typename T>
    Vector<T> local(const Vector<T>& point) const {
        return to_axes(point - Vector<T>(center_));
    }
    template <typename T>
    Vector<T> half_gradient(const Vector<T>& x) const {
        return Vector<T>(bend_) * x + Vector<T>(linear_);
    }

    // How far the surface may be off near points with such a largest coordinate and half a gradient of such a length:
    // by the roundings of the file's numbers, of the centre and of the axes.
    template <typename T>
    T error_of(const T& reach, const T& half_gradient) const {
        const T of_value = (T(second_error_) * reach + T(first_error_)) * reach + T(zeroth_error_);
        const T turn = T(turned_ ? 4 * tie_epsilon<Real> : Real(0)) * reach;
        return T(center_error_) + turn + of_value / (T(2) * half_gradient);
    }

    // The discriminant of (Bx.d)^2 - (Bd.d) (Bx.x) is minus the sum of b_j b_k w_i^2 with w = x cross d, by Lagrange's
    // identity, and with l it is more by (l.d)^2 + 2 Bd.(l cross w): so the squares of how far away the origin is never
    // cancel. Haines, Guenther and Akenine-Moller, "Precision Improvements for Ray/Sphere Intersection", Ray Tracing
    // Gems, 2019, ch. 7, do the same for the sphere.
    [[gnu::always_inline]] Equation equation_along(const Rays<Real>& rays) const {
        const Vector<L> x = local(rays.origin);
        const Vector<L> d = to_axes(rays.direction);
        Equation equation;
        equation.bent_direction = Vector<L>(bend_) * d;
        equation.half_gradient = Vector<L>(bend_) * x;
        equation.a = dot(equation.bent_direction, d) + L(Real(0));  // never -0
        const L k = constant_;
        const Vector<L> w = cross(x, d);
        equation.c = dot(equation.half_gradient, x) + k;
        equation.discriminant = -(equation.a * k) - dot(Vector<L>(minors_), w * w);
        if (!has_center_) {
            const Vector<L> l(linear_);
            const L slope = dot(l, d);
            equation.half_gradient += l;
            equation.c = equation.c + L(2) * dot(l, x);
            equation.discriminant =
                equation.discriminant + (slope * slope + L(2) * dot(equation.bent_direction, cross(l, w)));
        }
        equation.b = dot(equation.half_gradient, d);
        return equation;
    }

    // The roots are q / a and c / q, with q = -b -+ sqrt(discriminant) of the sign that adds: along a cone's side or a
    // paraboloid's axis, where a is 0, one is infinite and the other exact.
    [[gnu::always_inline]] void pass(const Equation& equation, const Rays<Real>& rays, Mask<Real> start,
                                     Mask<Real> inside, Passage<Real>& passage) const {
        const L zero = Real(0);
        const auto& [a, b, c, discriminant, half_gradient, bent_direction] = equation;
        const L root = sqrt(max(discriminant, zero));
        const L q = -(b + select(b >= zero, root, -root));
        const L one = q / a;
        const L other = c / q;
        passage.near = min(one, other);
        passage.far = max(one, other);
        passage.near_primitive = primitive_;
        passage.far_primitive = primitive_;
        passage.misses = ~(discriminant > zero) | touches(equation, rays);
        passage.inverted = (a < zero) | (passage.misses & (a <= zero) & (c <= zero));
        if (any(start)) {
            // A ray that is inside until the other end has the quadric between both.
            const L through = equation.other_end();
            const Mask<Real> leads_through =
                (through > zero) & (through < L(std::numeric_limits<Real>::infinity())) & ~(inside ^ (a > zero));
            passage.near = select(start, L(-std::numeric_limits<Real>::infinity()), passage.near);
            passage.far = select(start, through, passage.far);
            passage.misses = select(start, ~leads_through, passage.misses);
            passage.inverted = select(start & passage.misses, inside, passage.inverted);
        }
        if constexpr (decides_ties<Real>) {
            pass_along(equation, rays, select(start, abs(b), root), passage);
        }
    }

    // Where a ray runs along the surface, but for the error of its direction, it does not meet it: along the straight
    // lines in a cylinder, or a paraboloid's axis, the roots of an equation that is linear but for roundings are too
    // far away to be any. At both roots the gradient's product with the direction is `slope`.
    [[gnu::always_inline]] void pass_along(const Equation& equation, const Rays<Real>& rays, L slope,
                                           Passage<Real>& passage) const {
        const L infinity = std::numeric_limits<Real>::infinity();
        const L at_origin = max_norm(equation.half_gradient);
        const auto moved_away = [&](L t) {
            const L gradient = at_origin + abs(t) * L(most_bend_);  // it is no longer than twice that
            const Mask<Real> doubtful = (slope <= L(2) * rays.spread * gradient) & (gradient < infinity);
            if (!any(doubtful)) [[likely]] {
                return t;
            }
            const Vector<L> there = equation.half_gradient + t * equation.bent_direction;
            const Mask<Real> along = doubtful & ~(slope > rays.spread * length(there));
            return select(along, select(t < L(Real(0)), -infinity, infinity), t);
        };
        passage.near = moved_away(passage.near);
        passage.far = moved_away(passage.far);
    }

    // A ray that touches the quadric, but for its errors, passes it by.
    [[gnu::always_inline]] Mask<Real> touches(const Equation& equation, const Rays<Real>& rays) const {
        if constexpr (!decides_ties<Real>) {
            return Mask<Real>::none();
        }
        const auto& [a, b, c, discriminant, half_gradient, bent_direction] = equation;
        const Mask<Real> doubtful = discriminant <= L(most_of_radius<Real>) * (b * b + abs(a * c));
        if (!any(doubtful)) [[likely]] {
            return doubtful;
        }
        // Half way between the roots, where it touches.
        const L middle = -b / a;
        const Vector<L> there = half_gradient + middle * bent_direction;
        const L gradient2 = dot(there, there);
        const L gradient = sqrt(gradient2);
        const L off = rays.t_min + error_of(rays.reach + abs(middle), gradient);
        const L touching = L(2) * gradient * (abs(a) * off + abs(b) * rays.spread);
        return doubtful & (discriminant <= min(touching, L(most_of_radius<Real>) * gradient2));
    }

    Vector<Real> center_, bend_, linear_;
    Vector<Real> minors_;  // products of two of `bend_`
    Real constant_;
    bool has_center_;  // `linear_` is 0
    bool turned_;
    Vector<Real> axes_[3], rows_[3];  // the columns of the matrix of axes, and its rows
    Real most_bend_;
    Real center_error_, second_error_ = 0, first_error_ = 0, zeroth_error_ = 0;  // of the terms of each degree
    Real ball_reach2_;  // the square of the radius of a ball about the centre that holds the surface, or infinite
    int object_, primitive_;
};

extern template class Quadric<float>;  // in shapes.cpp
extern template class Quadric<double>;

}  // namespace whitted::WHITTED_ISA
