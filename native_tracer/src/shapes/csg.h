// Constructive solid geometry: a Boolean expression over primitives, its leaves. shapes.h says what a shape answers.
//
// A leaf is met twice at most, and all that is known of it along a ray is its passage. The expression's value just
// behind any place follows from all passages, so that what happens at the same distance happens at once: A - A is
// nothing, and where faces coincide there is no film. The surface is where the value changes. Roth, "Ray Casting for
// Modeling Solids", Computer Graphics and Image Processing 18(2), 1982, without his lists of intervals.
//
// A ray starts on a leaf's primitive, and with it on all primitives of other leaves that are the same surface: of all
// of them it is known on which side it travels, and no distance is compared.

#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "search/bounds.h"
#include "shapes/contact.h"
#include "shapes/convex_polyhedron.h"
#include "shapes/crossing.h"
#include "shapes/csg_boxes.h"
#include "shapes/csg_expression.h"
#include "shapes/csg_passages.h"
#include "shapes/csg_plan.h"
#include "shapes/csg_ties.h"
#include "shapes/quadric.h"
#include "shapes/shape_lists.h"
#include "shapes/sight.h"
#include "shapes/sphere.h"
#include "shapes/start.h"
#include "tracing/description.h"
#include "tracing/ray.h"
#include "tracing/rounding.h"
#include "tracing/triple.h"
#include "tracing/vector.h"

namespace whitted::WHITTED_ISA {

// Its primitives are the leaves' in order, once as the leaf has them and once more with their other side out.
template <typename Real>
class Csg {
 public:
    using L = Lanes<Real>;
    using Description = CsgDescription;
    using Sight = BallInSight<Real>;
    using Leaves = ShapeLists<Real, Sphere<Real>, ConvexPolyhedron<Real>, Quadric<Real>>;

    static int primitive_count(const CsgDescription& csg) { return 2 * piece_count(csg); }

    [[gnu::noinline]] Csg(const CsgDescription& csg, int object, int first_primitive)
        : plan_(plan_csg(csg, std::numeric_limits<Real>::digits)),
          boxes_(plan_),
          pieces_(plan_.first_piece.back()),
          object_(object),
          first_primitive_(first_primitive) {
        for (std::size_t i = 0; i < csg.leaves.size(); ++i) {
            const int first = plan_.first_piece[i];
            leaves_.push_back(
                {lists_.add(csg.leaves[i], object, first_primitive + first), first, plan_.first_piece[i + 1]});
        }
        find_box(csg);
    }

    int object() const { return object_; }
    int piece(int primitive) const { return piece_of(primitive); }

    // A ball that holds all, for its sight.
    const Vector<Real>& ball_center() const { return ball_center_; }
    Real ball_reach2() const { return ball_reach2_; }

    [[gnu::noinline]] Real error_at(int primitive, Real reach, const Vector<Real>& point) const {
        return lists_.visit(leaf_of(primitive).shape,
                            [&](const auto& leaf) { return leaf.error_at(unturned(primitive), reach, point); });
    }

    // How far a point surely lies outside the box around the body; not positive where it may lie inside.
    Real distance_outside(const Vector<Real>& point) const {
        const Vector<Real> below = low_ - point;
        const Vector<Real> above = point - high_;
        const Real error = 32 * std::numeric_limits<Real>::epsilon() * (length(point) + length(ball_center_));
        return std::max({below.x, below.y, below.z, above.x, above.y, above.z}) - error;
    }

    template <bool which_primitive>
    [[gnu::always_inline]] bool intersect(const Rays<Real>& rays, const L& limit, Crossing<Real>& crossing,
                                          Mask<Real>&) const {
        return intersect(rays, limit, crossing);
    }

    [[gnu::noinline]] bool intersect_by_rules(const Rays<Real>& rays, Crossing<Real>& crossing) const {
        return intersect(rays, L(std::numeric_limits<Real>::infinity()), crossing);
    }

    int primitive_met(const Rays<Real>&, int, int primitive, Real, bool) const { return primitive; }

    [[gnu::noinline]] Vector<Real> outward_at(int primitive, const Vector<Real>& point) const {
        const Vector<Real> outward = lists_.visit(
            leaf_of(primitive).shape, [&](const auto& leaf) { return leaf.outward_at(unturned(primitive), point); });
        return is_turned(primitive) ? -outward : outward;
    }

    [[gnu::noinline]] SurfacePoint<Real> surface_at(int primitive, const Vector<L>& near, const Rays<Real>& rays,
                                                    Mask<Real> inside) const {
        const bool turned = is_turned(primitive);
        SurfacePoint<Real> result = lists_.visit(leaf_of(primitive).shape, [&](const auto& leaf) {
            return leaf.surface_at(unturned(primitive), near, rays, turned ? ~inside : inside);
        });
        if (turned) {
            result.outward = -result.outward;
        }
        return result;
    }

    // With both sides out; what is inside which is the leaf's alone to say.
    template <typename Visit>
    void for_each_contact(const CsgDescription& csg, const Triple& point, Visit visit) const {
        for (std::size_t i = 0; i < leaves_.size(); ++i) {
            lists_.visit(leaves_[i].shape, csg.leaves[i], [&](const auto& leaf, const auto& description) {
                leaf.for_each_contact(description, point, [&](Contact<Real> contact) {
                    visit(contact);
                    contact.primitive += pieces_;
                    contact.outward = -contact.outward;
                    contact.body = -1;
                    contact.on_body = false;
                    visit(contact);
                });
            });
        }
    }

 private:
    using Event = typename CsgEvents<Real>::Event;

    struct Leaf {
        ShapeIndex shape;
        int first_piece, end_piece;
    };

    // ---- Primitives -------------------------------------------------------------------------------------------------

    static int piece_count(const CsgDescription& csg) {
        int count = 0;
        for (const LeafDescription& leaf : csg.leaves) {
            count += Leaves::primitive_count(leaf);
        }
        return count;
    }
    bool is_turned(int primitive) const { return primitive - first_primitive_ >= pieces_; }
    int piece_of(int primitive) const { return (primitive - first_primitive_) % pieces_; }
    int unturned(int primitive) const { return first_primitive_ + piece_of(primitive); }
    const Leaf& leaf_of(int primitive) const {
        return leaves_[static_cast<std::size_t>(plan_.leaf_of_piece[static_cast<std::size_t>(piece_of(primitive))])];
    }

    void find_box(const CsgDescription& csg) {
        constexpr Real infinity = std::numeric_limits<Real>::infinity();
        low_ = {-infinity, -infinity, -infinity};
        high_ = {infinity, infinity, infinity};
        ball_reach2_ = infinity;
        if (const std::optional<Bounds> bounds = bounds_of(csg)) {
            low_ = vector_of<Real>(bounds->box.low);
            high_ = vector_of<Real>(bounds->box.high);
            ball_center_ = Real(0.5) * low_ + Real(0.5) * high_;
            const Vector<Real> arm = high_ - ball_center_;
            const Real blur = 1024 * std::numeric_limits<Real>::epsilon() * static_cast<Real>(bounds->growth);
            const Real size = length(arm) + blur * (length(arm) + length(ball_center_));
            ball_reach2_ = size * size;
        }
    }

    // ---- Along rays -------------------------------------------------------------------------------------------------

    Start<Real> start_of(const Rays<Real>& rays) const {
        Start<Real> start;
        start.here = rays.object == Indices<Real>(object_);
        start.any = whitted::WHITTED_ISA::any(start.here);
        if (start.any) {
            const Mask<Real> turned = rays.primitive >= Indices<Real>(first_primitive_ + pieces_);
            start.primitive = select(turned, rays.primitive + Indices<Real>(-pieces_), rays.primitive);
            const auto side_of = [&](int lane) {
                return start.here[lane]
                           ? plan_.sides[static_cast<std::size_t>(start.primitive[lane] - first_primitive_)]
                           : Side{-1, false};
            };
            start.surface = Indices<Real>::gather([&](int lane) { return side_of(lane).surface; });
            const Mask<Real> reversed = Mask<Real>::gather([&](int lane) { return side_of(lane).reversed; });
            start.inner = rays.inside ^ turned ^ reversed;
        }
        return start;
    }

    void pass_leaves(const Rays<Real>& rays, const L& limit, const Start<Real>& start,
                     CsgPassages<Real>& passages) const {
        reduce(plan_, boxes_.uses_met(plan_, rays, limit), passages.expression);
        const L infinity = std::numeric_limits<Real>::infinity();
        const Mask<Real> wanted = limit >= L(Real(0));
        passages.count = 0;
        for (std::uint64_t left = passages.expression.leaves(); left != 0; left &= left - 1) {
            const int i = std::countr_zero(left);
            passages.place[i] = -1;
            const Leaf& leaf = leaves_[static_cast<std::size_t>(i)];
            Passage<Real> passage;
            const L between = lists_.visit(leaf.shape, [&](const auto& shape) {
                return shape.pass(rays, start, plan_.sides.data() + leaf.first_piece, passage);
            });
            const Mask<Real> meets = ~passage.misses & wanted;
            if (start.any) {
                // The other end of what a ray starts on is ahead, however near.
                const Mask<Real> own = start.here &
                                       (start.primitive >= Indices<Real>(first_primitive_ + leaf.first_piece)) &
                                       (start.primitive < Indices<Real>(first_primitive_ + leaf.end_piece));
                const L ahead = rays.t_min * L(1 + 4 * std::numeric_limits<Real>::epsilon());
                passage.far = select(own, max(passage.far, ahead), passage.far);
            }
            if (!any(meets) && !any(passage.inverted & wanted)) {
                continue;
            }
            passages.place[i] = passages.count;
            passages.leaf[passages.count] = i;
            passages.ends[passages.count++] = {select(meets, passage.near, infinity),
                                               select(meets, passage.far, infinity),
                                               passage.near_primitive,
                                               passage.far_primitive,
                                               passage.inverted,
                                               between};
        }
    }

    // Out of line, for others' sake: it is long.
    [[gnu::noinline]] bool intersect(const Rays<Real>& rays, const L& limit, Crossing<Real>& crossing) const {
        const Start<Real> start = start_of(rays);
        CsgPassages<Real> passages;
        pass_leaves(rays, limit, start, passages);
        if (passages.count == 0) {
            return false;
        }
        const L infinity = std::numeric_limits<Real>::infinity();
        L next;
        crossing.t = infinity;
        crossing.inside = passages.value_behind(rays.t_min, next);
        // Beyond it, but for what may tie with it, nothing is asked.
        const L last = limit + L(most_blur<Real>) * (limit + rays.reach);
        Mask<Real> open = limit >= L(Real(0));
        for (;;) {
            open &= (next < infinity) & ~(next > last);  // it may be NaN
            if (!any(open)) {
                break;
            }
            const L at = next;
            const Mask<Real> changes = open & (passages.value_behind(at, next) ^ crossing.inside);
            crossing.t = select(changes, at, crossing.t);
            open &= ~changes;
        }
        if (!any(crossing.t < infinity)) {
            return false;
        }
        find_primitives(rays, start, passages, crossing);
        return true;
    }

    // The primitives met at the crossings, those of the first leaves that are met there.
    void find_primitives(const Rays<Real>& rays, const Start<Real>& start, const CsgPassages<Real>& passages,
                         Crossing<Real>& crossing) const {
        const L range = L(most_blur<Real>) * (rays.reach + crossing.t);
        const Indices<Real> other_side = pieces_;
        const Indices<Real> same_side = 0;
        Mask<Real> found = Mask<Real>::none();
        Mask<Real> close = Mask<Real>::none();
        crossing.primitive = first_primitive_;
        for (int i = 0; i < passages.count; ++i) {
            const auto& ends = passages.ends[i];
            const auto meet = [&](const L& t, const Indices<Real>& primitive, Mask<Real> enters) {
                const Mask<Real> here = abs(t - crossing.t) <= range;
                const Mask<Real> first = (t <= crossing.t) & (t >= crossing.t) & ~found;
                close |= (here & ~first) | (first & (ends.between_primitives < range));
                crossing.primitive = select(first, primitive + select(enters ^ crossing.inside, same_side, other_side),
                                            crossing.primitive);
                found |= first;
            };
            meet(ends.near, ends.near_primitive, ~ends.inverted);
            meet(ends.far, ends.far_primitive, ends.inverted);
        }
        close &= crossing.t < L(std::numeric_limits<Real>::infinity());
        for (unsigned lanes = close.bits(); lanes != 0; lanes &= lanes - 1) [[unlikely]] {
            settle(rays, start, std::countr_zero(lanes), passages, crossing);
        }
    }

    // ---- Ties -------------------------------------------------------------------------------------------------------

    // Decides for one ray between leaves that it meets at the same place but for rounding errors.
    [[gnu::noinline]] void settle(const Rays<Real>& rays, const Start<Real>& start, int lane,
                                  const CsgPassages<Real>& passages, Crossing<Real>& crossing) const {
        const auto error_of = [&](const Event& event) {
            return tie_error(*this, rays, lane, event.primitive, event.t);
        };
        const auto change = CsgEvents<Real>(passages, rays, lane).first_change(plan_, error_of);
        const Mask<Real> here = Mask<Real>::only(lane);
        if (!change) {
            crossing.t = select(here, L(std::numeric_limits<Real>::infinity()), crossing.t);
            return;
        }
        const bool same_side = change->met.enters != change->before;
        const int primitive = first_of_leaf(rays, start, lane, change->met) + (same_side ? 0 : pieces_);
        crossing.t = select(here, L(change->t), crossing.t);
        crossing.primitive = select(here, Indices<Real>(primitive), crossing.primitive);
        crossing.inside = change->before ? crossing.inside | here : crossing.inside & ~here;
    }

    // Of the leaf's primitives that a ray meets there, the first.
    int first_of_leaf(const Rays<Real>& rays, const Start<Real>& start, int lane, const Event& event) const {
        Rays<Real> unturned = rays;
        if (start.any) {
            unturned.primitive = start.primitive;
        }
        return lists_.visit(leaves_[static_cast<std::size_t>(event.leaf)].shape, [&](const auto& leaf) {
            return leaf.primitive_met(unturned, lane, event.primitive, event.t, !event.enters);
        });
    }

    CsgPlan plan_;
    CsgBoxes<Real> boxes_;
    Leaves lists_;
    std::vector<Leaf> leaves_;
    Vector<Real> low_, high_;  // the corners of a box that holds all, or infinite
    Vector<Real> ball_center_{0, 0, 0};
    Real ball_reach2_;  // the square of the radius of a ball about that centre which holds all, or infinite
    int pieces_, object_, first_primitive_;
};

extern template class Csg<float>;  // in shapes.cpp
extern template class Csg<double>;

}  // namespace whitted::WHITTED_ISA
