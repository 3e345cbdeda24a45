// Where rays meet spheres and quadrics, by equations of the second degree.

#pragma once

#include "prepared.h"
#include "rays.h"
#include "surfaces.h"
#include "undecided.h"

namespace certified {

// `own`: the ray starts on the body that is this surface alone.
template <typename End>
class Quadratics {
 public:
    using I = Interval<End>;
    using V = Vector<I>;
    using R = Ray<End>;
    using S = typename PreparedScene<End>::PreparedSurface;

    Quadratics(const Surfaces<End>& surfaces, Judge<End>& judge) : surfaces_(surfaces), judge_(judge) {}

    // a t^2 + 2 b t + c = 0, with the discriminant r^2 a - |arm x d|^2, Lagrange's identity for b^2 - a c.
    Passage<End> pass_sphere(int index, const R& ray, bool own) {
        const S& s = surfaces_[index];
        const V arm = ray.origin - s.vector;
        const I b = dot(arm, ray.direction);
        const bool at_start = surfaces_.starts_on(s, ray);
        if (!at_start && !own) {
            const I a = length2(ray.direction), r2 = square(s.number);
            const I discriminant = r2 * a - length2(cross(arm, ray.direction));
            if (discriminant.negative()) {
                return {};
            }
            const I c = length2(arm) - r2;
            if (b.positive() && c.positive()) {
                return {};
            }
            if (judge_.sign(discriminant, Reason::hit) <= 0) {
                return {};
            }
            return between_roots(index, ray, a, b, c, sqrt(discriminant), judge_.sign(c, Reason::hit));
        }
        const I a = length2(ray.direction);
        const bool inward = (own && ray.inside) || judge_.sign(b, Reason::hit) < 0;
        Passage<End> result;
        result.inside = inward;
        if (inward) {
            // Inward from the surface itself, b is negative, however little of it is known.
            const I t = surfaces_.ends_on(s, ray) ? I(1) : I(-2) * b / a;
            if (!t.positive()) {
                judge_.sign(t, Reason::hit);
            }
            result.add(t, index);
        }
        return result;
    }

    Passage<End> pass_quadric(int index, const R& ray, bool own) {
        const S& s = surfaces_[index];
        const auto& q = s.numbers;
        const V &d = ray.direction, &p = ray.origin;
        const I a = q[0] * square(d.x) + q[1] * square(d.y) + q[2] * square(d.z) + q[3] * d.x * d.y + q[4] * d.x * d.z +
                    q[5] * d.y * d.z;
        const I b2 = dot(surfaces_.gradient(s, p), d);  // 2 b
        const int second = judge_.sign(a, Reason::hit);
        Passage<End> result;
        if (own || surfaces_.starts_on(s, ray)) {
            const int first = own && second == 0 ? (ray.inside ? -1 : 1) : judge_.sign(b2, Reason::hit);
            result.inside = own ? ray.inside : goes_inside(first, second);
            if (surfaces_.ends_on(s, ray)) {
                if (second != 0) {
                    result.add(I(1), index);
                }
            } else if (first * second < 0) {
                result.add(-b2 / a, index);
            }
            return result;
        }
        const I c = surfaces_.value(s, p);
        const int side = judge_.sign(c, Reason::hit);
        if (side == 0) {
            // It starts there by rule.
            const int first = judge_.sign(b2, Reason::hit);
            result.inside = goes_inside(first, second);
            if (first * second < 0) {
                result.add(-b2 / a, index);
            }
            return result;
        }
        result.inside = side < 0;
        if (second == 0) {
            const int slope = judge_.sign(b2, Reason::hit);
            if (slope * side < 0) {
                result.add(surfaces_.ends_on(s, ray) ? I(1) : -c / b2, index);
            }
            return result;
        }
        const I b = I(0.5) * b2;
        const I discriminant = square(b) - a * c;
        if (second * side > 0) {
            // Both roots have one sign, that of -b a: none is ahead, or both are; else one is.
            if (discriminant.negative() || (second > 0 ? b.positive() : b.negative()) ||
                judge_.sign(discriminant, Reason::hit) <= 0) {
                return result;
            }
        }
        result = second > 0 ? between_roots(index, ray, a, b, c, sqrt(discriminant), side)
                            : between_roots(index, ray, -a, -b, -c, sqrt(discriminant), -side);
        result.inside = side < 0;
        return result;
    }

 private:
    // The crossings at (-b -+ root) / a, for a > 0 and c not 0.
    Passage<End> between_roots(int index, const R& ray, const I& a, const I& b, const I& c, const I& root, int side) {
        Passage<End> result;
        result.inside = side < 0;
        const S& s = surfaces_[index];
        if (surfaces_.ends_on(s, ray)) {
            // One root is 1, and the other c / a.
            const I other = c / a;
            if (side < 0) {
                result.add(I(1), index);
            } else if (judge_.sign(other, Reason::shadow) > 0) {
                const bool first = judge_.sign(other - I(1), Reason::shadow) < 0;
                result.add(first ? other : I(1), index);
                result.add(first ? I(1) : other, index);
            }
            return result;
        }
        if (side < 0) {
            // The root that is positive, by the formula without a difference of like numbers.
            result.add(b.positive() ? -c / (b + root) : (root - b) / a, index);
        } else if (judge_.sign(b, Reason::hit) < 0) {
            const I sum = root - b;
            result.add(c / sum, index);
            result.add(sum / a, index);
        }
        return result;
    }

    // Of a ray that starts on a quadric, by the signs of its values' first and second derivative along the ray. In the
    // surface itself it is inside: a body is closed.
    static bool goes_inside(int first, int second) { return first != 0 ? first < 0 : second <= 0; }

    const Surfaces<End>& surfaces_;
    Judge<End>& judge_;
};

}  // namespace certified
