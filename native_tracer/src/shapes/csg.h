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
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "search/bounds.h"
#include "shapes/contact.h"
#include "shapes/convex_polyhedron.h"
#include "shapes/crossing.h"
#include "shapes/csg_plan.h"
#include "shapes/quadric.h"
#include "shapes/shape_lists.h"
#include "shapes/sight.h"
#include "shapes/sphere.h"
#include "shapes/start.h"
#include "tracing/box_test.h"
#include "tracing/description.h"
#include "tracing/ray.h"
#include "tracing/vector.h"

namespace whitted::WHITTED_ISA {

template <typename Real>
class CsgSight;

// Its primitives are the leaves' in order, once as the leaf has them and once more with their other side out.
template <typename Real>
class Csg {
 public:
    using L = Lanes<Real>;
    using Description = CsgDescription;
    using Sight = CsgSight<Real>;
    using Leaves = ShapeLists<Real, Sphere<Real>, ConvexPolyhedron<Real>, Quadric<Real>>;

    static int primitive_count(const CsgDescription& csg) { return 2 * piece_count(csg); }

    [[gnu::noinline]] Csg(const CsgDescription& csg, int object, int first_primitive)
        : plan_(plan_csg(csg, std::numeric_limits<Real>::digits)),
          space_(plan_.tree, plan_.growth, plan_.reach),
          pieces_(plan_.first_piece.back()),
          object_(object),
          first_primitive_(first_primitive) {
        for (std::size_t i = 0; i < csg.leaves.size(); ++i) {
            const int first = plan_.first_piece[i];
            leaves_.push_back(
                {lists_.add(csg.leaves[i], object, first_primitive + first), first, plan_.first_piece[i + 1]});
        }
        find_box(csg);
        for (const BvhNode& node : plan_.tree.nodes) {
            nodes_.push_back({space_.box(node.box), static_cast<int>(node.children), static_cast<int>(node.first),
                              static_cast<int>(node.first + node.count)});
        }
    }

    int object() const { return object_; }
    int piece(int primitive) const { return piece_of(primitive); }

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
    friend class CsgSight<Real>;

    struct Leaf {
        ShapeIndex shape;
        int first_piece, end_piece;
    };

    // What a ray's passage through a leaf leaves to be known.
    struct Ends {
        L near, far;
        Indices<Real> near_primitive, far_primitive;
        Mask<Real> inverted;
        L between_primitives;  // the least distance between two of the leaf's own
    };

    // The passages through the leaves that some ray may meet, by the order of the leaves, and what is left of the
    // expression without the others.
    struct Passages {
        Ends ends[most_csg_leaves];
        int leaf[most_csg_leaves];   // whose they are
        int place[most_csg_leaves];  // of those of a leaf that is left, or -1: no ray meets it
        int count;
        CsgStep steps[2 * most_csg_leaves];
        int step_count;
    };

    struct Node {
        CoarseBox<Real> box;
        int children;  // the first of two neighbours; 0: it holds the leaves of the tree's order from first to end
        int first, end;
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

    // ---- Boxes ------------------------------------------------------------------------------------------------------

    void find_box(const CsgDescription& csg) {
        constexpr Real infinity = std::numeric_limits<Real>::infinity();
        low_ = {-infinity, -infinity, -infinity};
        high_ = {infinity, infinity, infinity};
        reach2_ = infinity;
        if (const std::optional<Bounds> bounds = bounds_of(csg)) {
            low_ = vector_of<Real>(bounds->box.low);
            high_ = vector_of<Real>(bounds->box.high);
            ball_center_ = Real(0.5) * low_ + Real(0.5) * high_;
            const Vector<Real> arm = high_ - ball_center_;
            const Real blur = 1024 * std::numeric_limits<Real>::epsilon() * static_cast<Real>(bounds->growth);
            const Real size = length(arm) + blur * (length(arm) + length(ball_center_));
            reach2_ = size * size;
        }
    }

    // The uses of the leaves that some ray may meet, a bit each.
    std::uint64_t uses_met(const Rays<Real>& rays, const L& limit) const {
        std::uint64_t met = 0;
        for (const int leaf : plan_.apart) {
            met |= plan_.uses[static_cast<std::size_t>(leaf)];
        }
        if (nodes_.empty()) {
            return met;
        }
        const BoxTest<Real> test(rays, space_);
        const Coarse<Real> bound = test.bound(limit);
        int waiting[most_csg_leaves];
        int depth = 0;
        waiting[depth++] = 0;
        while (depth > 0) {
            const Node& node = nodes_[static_cast<std::size_t>(waiting[--depth])];
            Coarse<Real> since;
            if (!test(node.box, bound, since)) {
                continue;
            }
            if (node.children != 0) {
                waiting[depth++] = node.children;
                waiting[depth++] = node.children + 1;
                continue;
            }
            for (int i = node.first; i < node.end; ++i) {
                met |= plan_.uses[plan_.tree.order[static_cast<std::size_t>(i)]];
            }
        }
        return met;
    }

    // Leaves out of the expression the leaves that no ray meets: they are empty, and so may be what they are part of.
    // `met` are the uses of the others. Returns the leaves that are left, a bit each.
    std::uint64_t reduce(std::uint64_t met, Passages& passages) const {
        constexpr int empty = -1;
        int stack[deepest_csg_stack];  // where each operand begins
        int size = 0;
        int end = 0;
        for (std::uint64_t uses = met | plan_.needed; uses != 0; uses &= uses - 1) {
            const auto use = static_cast<std::size_t>(std::countr_zero(uses));
            const bool is_met = (met >> use & 1) != 0;
            for (int i = plan_.first_step[use]; i < plan_.first_step[use + 1]; ++i) {
                const CsgStep& step = plan_.steps[static_cast<std::size_t>(i)];
                const bool is_leaf = step.leaf >= 0;
                const int right = !is_leaf ? stack[--size] : is_met ? end : empty;
                if (step.operation == CsgStep::push) {
                    stack[size++] = right;
                    passages.steps[end] = step;
                    end += is_met;
                    continue;
                }
                int& left = stack[size - 1];
                if (left != empty && right != empty) {
                    passages.steps[end++] = step;
                } else if (step.operation == CsgDescription::unite) {
                    if (right != empty && is_leaf) {
                        passages.steps[end++] = {step.leaf, CsgStep::push};
                    }
                    left = std::max(left, right);
                } else if (step.operation == CsgDescription::intersect || left == empty) {
                    const int operand = std::max(left, right);
                    end = operand == empty ? end : operand;
                    left = empty;
                }
            }
        }
        passages.step_count = end;
        std::uint64_t leaves = 0;
        for (int i = 0; i < end; ++i) {
            if (passages.steps[i].leaf >= 0) {
                leaves |= std::uint64_t(1) << passages.steps[i].leaf;
            }
        }
        return leaves;
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

    void pass_leaves(const Rays<Real>& rays, const L& limit, const Start<Real>& start, Passages& passages) const {
        const std::uint64_t leaves = reduce(uses_met(rays, limit), passages);
        const L infinity = std::numeric_limits<Real>::infinity();
        const Mask<Real> wanted = limit >= L(Real(0));
        passages.count = 0;
        for (std::uint64_t left = leaves; left != 0; left &= left - 1) {
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

    // The expression's value just behind distance t, and the next distance at which a leaf is met. The stack's top is
    // not in memory: most operands are combined with it at once.
    [[gnu::always_inline]] Mask<Real> value_behind(const Passages& passages, const L& t, L& next) const {
        const L infinity = std::numeric_limits<Real>::infinity();
        Mask<Real> stack[deepest_csg_stack];
        Mask<Real> top = Mask<Real>::none();
        int size = 0;
        next = infinity;
        for (int i = 0; i < passages.step_count; ++i) {
            const CsgStep& step = passages.steps[i];
            Mask<Real> right = Mask<Real>::none();
            if (step.leaf < 0) {
                right = top;
                top = stack[--size];
            } else if (const int place = passages.place[step.leaf]; place >= 0) {
                const Ends& ends = passages.ends[place];
                const Mask<Real> entered = ends.near <= t;
                const Mask<Real> not_left = t < ends.far;
                right = (entered & not_left) ^ ends.inverted;
                next = min(select(entered, infinity, ends.near), next);
                next = min(select(not_left, ends.far, infinity), next);
            }
            if (step.operation == CsgStep::push) {
                stack[size++] = top;
                top = right;
            } else {
                top = step.operation == CsgDescription::unite      ? top | right
                      : step.operation == CsgDescription::subtract ? top & ~right
                                                                   : top & right;
            }
        }
        return top;
    }

    // Out of line, for others' sake: it is long.
    [[gnu::noinline]] bool intersect(const Rays<Real>& rays, const L& limit, Crossing<Real>& crossing) const {
        const Start<Real> start = start_of(rays);
        Passages passages;
        pass_leaves(rays, limit, start, passages);
        if (passages.count == 0) {
            return false;
        }
        const L infinity = std::numeric_limits<Real>::infinity();
        L next;
        crossing.t = infinity;
        crossing.inside = value_behind(passages, rays.t_min, next);
        // Beyond it, but for what may tie with it, nothing is asked.
        const L last = limit + L(most_blur<Real>) * (limit + rays.reach);
        Mask<Real> open = limit >= L(Real(0));
        for (;;) {
            open &= (next < infinity) & ~(next > last);  // it may be no number
            if (!any(open)) {
                break;
            }
            const L at = next;
            const Mask<Real> changes = open & (value_behind(passages, at, next) ^ crossing.inside);
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
    void find_primitives(const Rays<Real>& rays, const Start<Real>& start, const Passages& passages,
                         Crossing<Real>& crossing) const {
        const L range = L(most_blur<Real>) * (rays.reach + crossing.t);
        const Indices<Real> other_side = pieces_;
        const Indices<Real> same_side = 0;
        Mask<Real> found = Mask<Real>::none();
        Mask<Real> close = Mask<Real>::none();
        crossing.primitive = first_primitive_;
        for (int i = 0; i < passages.count; ++i) {
            const Ends& ends = passages.ends[i];
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

    // A leaf is met.
    struct Event {
        Real t;
        int leaf, primitive;
        bool enters;
    };

    // Decides for one ray between places that are the same but for rounding errors. All that happens there happens at
    // once: a film that is no thicker than the errors is none.
    [[gnu::noinline]] void settle(const Rays<Real>& rays, const Start<Real>& start, int lane, const Passages& passages,
                                  Crossing<Real>& crossing) const {
        Event events[2 * most_csg_leaves];
        int count = 0;
        std::uint64_t inside = 0;  // of which leaves the ray is
        for (int i = 0; i < passages.count; ++i) {
            const Ends& ends = passages.ends[i];
            const int leaf = passages.leaf[i];
            const bool inverted = ends.inverted[lane];
            bool in = inverted;
            const auto add = [&](Real t, int primitive, bool enters) {
                if (t <= rays.t_min[lane]) {
                    in = enters;
                } else if (std::isfinite(t)) {
                    events[count++] = {t, leaf, primitive, enters};
                }
            };
            if (ends.near[lane] < ends.far[lane]) {
                add(ends.near[lane], ends.near_primitive[lane], !inverted);
                add(ends.far[lane], ends.far_primitive[lane], inverted);
            }
            inside |= std::uint64_t(in) << leaf;
        }
        // By distance, and the first leaf first.
        for (int i = 1; i < count; ++i) {
            for (int k = i; k > 0 && events[k].t < events[k - 1].t; --k) {
                const Event later = events[k - 1];
                events[k - 1] = events[k];
                events[k] = later;
            }
        }
        crossing.t = replaced(crossing.t, lane, std::numeric_limits<Real>::infinity());
        for (int first = 0; first < count;) {
            int end = first + 1;
            for (Real error = error_of(rays, lane, events[first]); end < count; ++end) {
                const Real next_error = error_of(rays, lane, events[end]);
                if (!(events[end].t - events[end - 1].t <= error + next_error)) {
                    break;
                }
                error = next_error;
            }
            const bool before = value(inside);
            std::uint64_t after = inside;
            Real t = events[first].t;
            for (int k = first; k < end; ++k) {
                const bool changes = value(after ^ bit(events[k])) != value(after);
                after ^= bit(events[k]);
                t = changes ? events[k].t : t;
            }
            if (value(after) != before) {
                const Event& met = *first_met(events + first, events + end, inside, after);
                crossing.t = replaced(crossing.t, lane, t);
                const int primitive = first_of_leaf(rays, start, lane, met) + (met.enters != before ? 0 : pieces_);
                crossing.primitive = Indices<Real>::gather(
                    [&](int other) { return other == lane ? primitive : crossing.primitive[other]; });
                crossing.inside =
                    Mask<Real>::gather([&](int other) { return other != lane ? crossing.inside[other] : before; });
                return;
            }
            inside = after;
            first = end;
        }
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

    static L replaced(const L& lanes, int lane, Real value) {
        return L::gather([&](int other) { return other == lane ? value : lanes[other]; });
    }

    static std::uint64_t bit(const Event& event) { return std::uint64_t(1) << event.leaf; }

    // Of events at once, the first leaf's among those that make a difference: by themselves, or by being left out.
    const Event* first_met(const Event* begin, const Event* end, std::uint64_t before, std::uint64_t after) const {
        const Event* first = nullptr;
        for (const Event* event = begin; event != end; ++event) {
            const bool matters =
                value(before ^ bit(*event)) != value(before) || value(after ^ bit(*event)) != value(after);
            if (matters && (first == nullptr || event->primitive < first->primitive)) {
                first = event;
            }
        }
        return first == nullptr ? begin : first;
    }

    Real error_of(const Rays<Real>& rays, int lane, const Event& event) const {
        const Real error = distance_error(*this, rays, lane, event.primitive, event.t);
        const Real most = most_blur<Real> * (event.t + rays.reach[lane]);
        return error <= most ? error : most;
    }

    // The expression's value inside these leaves, its stack the bits of a number.
    bool value(std::uint64_t inside) const {
        std::uint64_t stack = 0;
        for (const CsgStep& step : plan_.steps) {
            const std::uint64_t right = (step.leaf >= 0 ? inside >> step.leaf : stack) & 1;
            stack >>= step.leaf >= 0 ? 0 : 1;
            if (step.operation == CsgStep::push) {
                stack = stack << 1 | right;
                continue;
            }
            const std::uint64_t left = stack & 1;
            const std::uint64_t result = step.operation == CsgDescription::unite      ? left | right
                                         : step.operation == CsgDescription::subtract ? left & ~right
                                                                                      : left & right;
            stack = stack >> 1 << 1 | result;
        }
        return stack != 0;
    }

    CsgPlan plan_;
    BoxSpace<Real> space_;
    Leaves lists_;
    std::vector<Leaf> leaves_;
    std::vector<Node> nodes_;  // the plan's tree
    Vector<Real> low_, high_;  // the corners of a box that holds all, or infinite
    Vector<Real> ball_center_{0, 0, 0};
    Real reach2_;  // the square of the radius of a ball about that centre which holds all, or infinite
    int pieces_, object_, first_primitive_;
};

extern template class Csg<float>;  // in shapes.cpp
extern template class Csg<double>;

template <typename Real>
class CsgSight : public BallInSight<Real> {
 public:
    CsgSight(const Csg<Real>& csg, const Vector<Real>& point, Real extent)
        : BallInSight<Real>(csg.ball_center_, csg.reach2_, point, extent) {}
};

}  // namespace whitted::WHITTED_ISA
