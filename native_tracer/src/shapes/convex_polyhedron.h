// The convex polyhedron: an intersection of half-spaces. shapes.h says what a shape answers.

#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

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

// The border of a half-space: inside is dot(normal, p) + offset <= 0.
template <typename Real>
struct Plane {
    Vector<Real> normal;  // a unit vector, outward
    Real offset;
    Real error, error_by_reach;  // how far it may be off, and by how much more for each unit of a coordinate
};

template <typename Real>
Plane<Real> plane_of(const Quadruple& plane) {
    // A normal may have any length: its square must neither overflow nor vanish, in float too.
    const int exponent = std::ilogb(std::max({std::abs(plane[0]), std::abs(plane[1]), std::abs(plane[2])}));
    const auto scaled = [&](std::size_t i) { return std::scalbn(plane[i], -exponent); };
    const Vector<Real> normal = vector_of<Real>({scaled(0), scaled(1), scaled(2)});
    const Real offset = static_cast<Real>(scaled(3)) / length(normal);
    const bool along_axis = (normal.x != 0) + (normal.y != 0) + (normal.z != 0) == 1;
    const Real slack = 4 * tie_epsilon<Real>;
    if (along_axis) {
        return {normal / length(normal), offset, input_error(offset), 0};
    }
    return {normal / length(normal), offset, slack * std::abs(offset), slack};
}

template <typename Real>
class ConvexPolyhedron {
 public:
    using L = Lanes<Real>;
    using Description = PolyhedronDescription;
    using Sight = AlwaysInSight<Real>;

    static int primitive_count(const PolyhedronDescription& polyhedron) {
        return static_cast<int>(polyhedron.planes.size());
    }

    ConvexPolyhedron(const PolyhedronDescription& polyhedron, int object, int first_primitive)
        : object_(object), first_primitive_(first_primitive) {
        planes_.reserve(polyhedron.planes.size());
        for (const Quadruple& plane : polyhedron.planes) {
            planes_.push_back(plane_of<Real>(plane));
        }
    }

    int object() const { return object_; }
    int piece(int primitive) const { return primitive - first_primitive_; }
    Real error_at(int primitive, Real reach, const Vector<Real>&) const { return error_of(primitive, reach); }

    // The ray is inside all half-spaces between the largest t at which it enters one and the smallest at which it
    // leaves one. Planes may be few and close no volume: either bound may stay infinite. Haines, "Fast Ray-Convex
    // Polyhedron Intersection", Graphics Gems II, 1991. Out of line, so that the loop has all registers to itself.
    template <bool which_primitive>
    [[gnu::noinline]] bool intersect(const Rays<Real>& rays, const L&, Crossing<Real>& crossing,
                                     Mask<Real>& close) const {
        const L zero = Real(0);
        const L infinity = std::numeric_limits<Real>::infinity();
        const Mask<Real> starts_here = rays.object == Indices<Real>(object_);
        const Mask<Real> from_within = starts_here & rays.inside;
        const Mask<Real> elsewhere = starts_here & ~rays.inside;
        if (all(elsewhere)) {
            return false;
        }
        Passage<Real> passage;
        passage.misses = elsewhere;
        L between_planes = infinity;
        if (!any(from_within)) {
            pass<Origin::elsewhere, which_primitive>(rays, passage, between_planes, close);
        } else if (which_primitive && all(from_within)) {
            pass<Origin::within, which_primitive>(rays, passage, between_planes, close);
        } else {
            pass<Origin::mixed, which_primitive>(rays, passage, between_planes, close);
        }
        // Later planes only bring the ends of the passage farther apart.
        const L gap = passage.near - passage.far;
        const Mask<Real> at_edge =
            (gap > zero) & (gap <= L(most_blur<Real>) * (rays.reach + passage.near)) & ~elsewhere;
        if (any(at_edge)) [[unlikely]] {
            close |= at_edge;
        }
        if (all(passage.misses)) {
            return false;
        }
        crossing = first_crossing(passage, rays, from_within);
        if constexpr (which_primitive) {
            close |= (between_planes < L(most_blur<Real>) * (rays.reach + crossing.t)) & (crossing.t < infinity);
        }
        return true;
    }

    // The passage of rays through the polyhedron; of those that start on a plane `start` knows the side, on which they
    // stay. Returns the least distance between two planes that rays meet one after the other.
    L pass(const Rays<Real>& rays, const Start<Real>& start, const Side* sides, Passage<Real>& passage) const {
        const L zero = Real(0);
        passage.misses = Mask<Real>::none();
        passage.near_primitive = first_primitive_;
        passage.far_primitive = first_primitive_;
        Mask<Real> from_within = Mask<Real>::none();
        L between_planes = std::numeric_limits<Real>::infinity();
        for (int k = 0; k < plane_count(); ++k) {
            const Plane<Real>& plane = planes_[static_cast<std::size_t>(k)];
            const Vector<L> normal(plane.normal);
            const L slope = dot(normal, rays.direction) + zero;  // never -0, see above
            const L height = dot(normal, rays.origin) + L(plane.offset);
            const L t = -height / slope;
            const Indices<Real> primitive = first_primitive_ + k;
            const Mask<Real> entering = slope < zero;
            Mask<Real> leaves_first = ~entering & (t < passage.far);
            Mask<Real> enters_last = entering & (t > passage.near);
            between_planes = min(abs(t - select(entering, passage.near, passage.far)), between_planes);
            const Mask<Real> along = abs(slope) <= rays.spread;
            if (decides_ties<Real> && any(along)) [[unlikely]] {
                const L error = rays.t_min + error_of(first_primitive_ + k, rays.reach);
                passage.misses |= along & (height > error) & ~start.on(sides[k]);
                leaves_first &= ~along;
                enters_last &= ~along;
            }
            if (start.any) {
                const Mask<Real> here = start.on(sides[k]);
                const Mask<Real> within = here & start.within(sides[k]);
                from_within |= within & (start.primitive == primitive);
                passage.misses |= here & ~within;
                leaves_first &= ~here;
                enters_last &= ~here;
            }
            passage.far = select(leaves_first, t, passage.far);
            passage.far_primitive = select(leaves_first, primitive, passage.far_primitive);
            passage.near = select(enters_last, t, passage.near);
            passage.near_primitive = select(enters_last, primitive, passage.near_primitive);
            if (all((passage.near > passage.far) | (passage.far < rays.t_min) | passage.misses) && !start.any) {
                break;
            }
        }
        passage.near = select(from_within, L(-std::numeric_limits<Real>::infinity()), passage.near);
        passage.misses |= passage.near > passage.far;
        return between_planes;
    }

    // A ray along a plane neither enters nor leaves there, and is inside or outside by its height; one that meets an
    // edge hits, so that bodies which share the edge leave no gap.
    [[gnu::noinline]] bool intersect_by_rules(const Rays<Real>& rays, Crossing<Real>& crossing) const {
        const L zero = Real(0);
        const Mask<Real> starts_here = rays.object == Indices<Real>(object_);
        const Mask<Real> from_within = starts_here & rays.inside;
        Passage<Real> passage;
        passage.misses = starts_here & ~rays.inside;
        L enter_error = zero;
        L leave_error = zero;
        for (int k = 0; k < plane_count(); ++k) {
            const Plane<Real>& plane = planes_[static_cast<std::size_t>(k)];
            const Vector<L> normal(plane.normal);
            const L slope = dot(normal, rays.direction);
            const L height = dot(normal, rays.origin) + L(plane.offset);
            const Indices<Real> primitive = first_primitive_ + k;
            const L error = rays.t_min + error_of(first_primitive_ + k, rays.reach);
            const L t = select(abs(height) <= error, zero, -height / slope);
            const L t_error = (error + abs(t) * rays.spread) / abs(slope);

            const Mask<Real> along = abs(slope) <= rays.spread;
            const Mask<Real> enters_last = ~along & (slope < zero) & (t > passage.near);
            const Mask<Real> leaves_first =
                ~along & (slope > zero) & (t < passage.far) & ~(from_within & (rays.primitive == primitive));
            passage.near = select(enters_last, t, passage.near);
            passage.far = select(leaves_first, t, passage.far);
            passage.near_primitive = select(enters_last, primitive, passage.near_primitive);
            passage.far_primitive = select(leaves_first, primitive, passage.far_primitive);
            enter_error = select(enters_last, t_error, enter_error);
            leave_error = select(leaves_first, t_error, leave_error);
            passage.misses |= along & (height > error) & ~from_within;
        }
        passage.misses |= (passage.near - passage.far > enter_error + leave_error) & ~from_within;
        crossing = first_crossing(passage, rays, from_within);
        return true;
    }

    // The first of the planes that a ray meets where it has hit the polyhedron, at an edge or elsewhere.
    int primitive_met(const Rays<Real>& rays, int lane, int hit, Real t, bool inside) const {
        const Vector<Real> direction = lane_of(rays.direction, lane);
        const Vector<Real> p = lane_of(rays.origin, lane) + t * direction;
        const Real t_error = distance_error(*this, rays, lane, hit, t);
        const bool starts_here = rays.object[lane] == object_;
        for (int k = first_primitive_; k < hit; ++k) {
            const Plane<Real>& plane = plane_at(k);
            const Real slope = dot(plane.normal, direction);
            const Real error = blur(rays, lane, error_of(k, rays.reach[lane]), t) + t_error * std::abs(slope);
            const bool meets = inside ? slope > rays.spread[lane] : slope < -rays.spread[lane];
            if (meets && std::abs(dot(plane.normal, p) + plane.offset) <= error &&
                !(starts_here && rays.primitive[lane] == k)) {
                return k;
            }
        }
        return hit;
    }

    Vector<Real> outward_at(int primitive, const Vector<Real>&) const { return plane_at(primitive).normal; }

    SurfacePoint<Real> surface_at(int primitive, const Vector<L>& near, const Rays<Real>& rays, Mask<Real>) const {
        const Plane<Real>& plane = plane_at(primitive);
        const Vector<L> normal(plane.normal);
        return {near - (dot(normal, near) + L(plane.offset)) * normal, normal, error_of(primitive, rays.reach),
                L(Real(0))};
    }

    template <typename Visit>
    void for_each_contact(const PolyhedronDescription& polyhedron, const Triple& point, Visit visit) const {
        for (int k = 0; k < plane_count(); ++k) {
            const auto index = static_cast<std::size_t>(k);
            if (lies_on(polyhedron.planes[index], point)) {
                visit(Contact<Real>{object_,
                                    first_primitive_ + k,
                                    planes_[index].normal,
                                    Real(0),
                                    {},
                                    true,
                                    lies_within(polyhedron.planes, point),
                                    first_primitive_});
            }
        }
    }

    // How far a point surely lies beyond one of the planes; not positive where it may lie beyond none.
    Real distance_outside(const Vector<Real>& point) const {
        const Real reach = std::max({std::abs(point.x), std::abs(point.y), std::abs(point.z)});
        Real most = 0;
        for (const Plane<Real>& plane : planes_) {
            const Real error = 32 * std::numeric_limits<Real>::epsilon() * (reach + std::abs(plane.offset));
            most = std::max(most, dot(plane.normal, point) + plane.offset - error);
        }
        return most;
    }

    // The unit normal and the offset of each plane.
    const std::vector<Plane<Real>>& planes() const { return planes_; }

 private:
    // What is known of where rays start.
    enum class Origin { elsewhere, mixed, within };

    // The passage of rays that are far from ties, faster; adds those that are not to `close`.
    template <Origin origin, bool which_primitive>
    [[gnu::always_inline]] void pass(const Rays<Real>& rays, Passage<Real>& passage, L& between_planes,
                                     Mask<Real>& close) const {
        const L zero = Real(0);
        const Mask<Real> from_within = (rays.object == Indices<Real>(object_)) & rays.inside;
        int number = first_primitive_;
        for (const Plane<Real>& plane : planes_) {
            const Vector<L> normal(plane.normal);
            L slope = dot(normal, rays.direction);
            if constexpr (!decides_ties<Real>) {
                slope = slope + zero;  // never -0: a ray along the plane leaves it at -infinity if it runs outside
            }
            const L height = dot(normal, rays.origin) + L(plane.offset);
            const L t = -height / slope;
            const Indices<Real> primitive = number++;
            const Mask<Real> along = abs(slope) <= rays.spread;
            if (any(along)) [[unlikely]] {
                close |= along;
            }

            const Mask<Real> entering = slope < zero;
            if constexpr (which_primitive) {
                // NaN before the first plane.
                const L before = origin == Origin::within ? passage.far : select(entering, passage.near, passage.far);
                between_planes = min(abs(t - before), between_planes);
            }
            Mask<Real> leaves_first = ~entering & (t < passage.far);
            if constexpr (origin != Origin::elsewhere) {
                leaves_first &= ~(from_within & (rays.primitive == primitive));
            }
            passage.far = select(leaves_first, t, passage.far);
            passage.far_primitive = select(leaves_first, primitive, passage.far_primitive);
            if constexpr (origin == Origin::within) {
                continue;
            }
            const Mask<Real> enters_last = entering & (t > passage.near);
            passage.near = select(enters_last, t, passage.near);
            passage.near_primitive = select(enters_last, primitive, passage.near_primitive);

            Mask<Real> misses = (passage.near > passage.far) | (passage.far < rays.t_min);
            if constexpr (origin == Origin::mixed) {
                misses &= ~from_within;
            }
            passage.misses |= misses;
            if (all(passage.misses)) {
                return;
            }
        }
    }

    // How far a primitive may be off where rays of that reach are compared with it, see Rays.
    template <typename T>
    T error_of(int primitive, const T& reach) const {
        const Plane<Real>& plane = plane_at(primitive);
        return T(plane.error) + T(plane.error_by_reach) * reach;
    }

    int plane_count() const { return static_cast<int>(planes_.size()); }
    const Plane<Real>& plane_at(int primitive) const {
        return planes_[static_cast<std::size_t>(primitive - first_primitive_)];
    }

    std::vector<Plane<Real>> planes_;  // the primitives, in the order of the file
    int object_, first_primitive_;
};

}  // namespace whitted::WHITTED_ISA
