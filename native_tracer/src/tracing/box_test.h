// Rays against boxes.
//
// A box is tested so that no hit is lost which a test of its objects themselves would find, with all its rounding
// errors: it is widened by a bound of those, which is relative to the coordinates at hand.

#pragma once

#include <algorithm>
#include <limits>

#include "tracing/ray.h"
#include "tracing/rounding.h"
#include "tracing/vector.h"

namespace whitted::WHITTED_ISA {

// Where rays are in boxes: all that does not depend on the box.
template <typename Real>
class BoxTest {
 public:
    using L = Lanes<Real>;

    // Objects are found with errors of some 20 epsilon times the coordinates, of the ray's origin or their own, that
    // take part; planes that meet at sharp angles multiply them by up to `growth`. An origin may itself lie outside the
    // object that it is on, by less than t_min.
    BoxTest(const Rays<Real>& rays, Real growth, Real reach) {
        // Boxes are wider still, for what ties with a hit has to be come to, from wherever the ray may lead; nothing in
        // the tree is as far away as twice the sum of both reaches.
        const L both = rays.reach + L(reach);
        const L error = L(std::max(32 * std::numeric_limits<Real>::epsilon(), 4096 * tie_epsilon<Real>)) * both;
        L off = error + rays.t_min;
        if constexpr (decides_ties<Real>) {
            off = off + L(Real(4)) * both * rays.spread;
        }
        const L margin = L(growth) * off;
        const Vector<L> margins{margin, margin, margin};
        before_ = rays.origin + margins;
        behind_ = rays.origin - margins;
        inverse_ = {inverse(rays.direction.x), inverse(rays.direction.y), inverse(rays.direction.z)};
    }

    // The rays that are in the box somewhere between their origin and `limit`, and since when.
    [[gnu::always_inline]] Mask<Real> operator()(const Vector<Real>& low, const Vector<Real>& high, L limit,
                                                 L& since) const {
        L enter = Real(0);
        L leave = limit;
        clip(L(low.x), L(high.x), before_.x, behind_.x, inverse_.x, enter, leave);
        clip(L(low.y), L(high.y), before_.y, behind_.y, inverse_.y, enter, leave);
        clip(L(low.z), L(high.z), before_.z, behind_.z, inverse_.z, enter, leave);
        since = enter;
        return enter <= leave;
    }

 private:
    // Never infinite, so that no product with it is 0 times infinity.
    static L inverse(L slope) {
        const L least = std::numeric_limits<Real>::min();
        return L(Real(1)) / select(abs(slope) < least, least, slope);
    }

    [[gnu::always_inline]] static void clip(L low, L high, L before, L behind, L inverse, L& enter, L& leave) {
        const L one = (low - before) * inverse;
        const L other = (high - behind) * inverse;
        enter = max(enter, min(one, other));
        leave = min(leave, max(one, other));
    }

    Vector<L> before_, behind_;  // the origin, so moved that boxes need not be widened
    Vector<L> inverse_;
};

}  // namespace whitted::WHITTED_ISA
